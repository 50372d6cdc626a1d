# libzip: target ZipLibrary::zip. Its own package file on Debian requires programs of packages that it does not depend on.
find_path(ZipLibrary_INCLUDE_DIR zip.h)
find_library(ZipLibrary_LIBRARY zip)
mark_as_advanced(ZipLibrary_INCLUDE_DIR ZipLibrary_LIBRARY)
include(FindPackageHandleStandardArgs)
find_package_handle_standard_args(ZipLibrary REQUIRED_VARS ZipLibrary_LIBRARY ZipLibrary_INCLUDE_DIR)
if(ZipLibrary_FOUND AND NOT TARGET ZipLibrary::zip)
  add_library(ZipLibrary::zip UNKNOWN IMPORTED)
  set_target_properties(ZipLibrary::zip PROPERTIES IMPORTED_LOCATION ${ZipLibrary_LIBRARY}
    INTERFACE_INCLUDE_DIRECTORIES ${ZipLibrary_INCLUDE_DIR})
endif()
