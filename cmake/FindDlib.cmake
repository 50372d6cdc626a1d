# dlib's headers: target Dlib::headers. Only header-only parts are used; dlib's own package file requires X11, SQLite
# and a BLAS.
find_path(Dlib_INCLUDE_DIR dlib/optimization/max_cost_assignment.h)
mark_as_advanced(Dlib_INCLUDE_DIR)
include(FindPackageHandleStandardArgs)
find_package_handle_standard_args(Dlib DEFAULT_MSG Dlib_INCLUDE_DIR)
if(Dlib_FOUND AND NOT TARGET Dlib::headers)
  add_library(Dlib::headers INTERFACE IMPORTED)
  set_target_properties(Dlib::headers PROPERTIES INTERFACE_INCLUDE_DIRECTORIES ${Dlib_INCLUDE_DIR})
endif()
