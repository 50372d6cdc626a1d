# cpack -G DEB: Debian packages of what cmake/install.cmake installs, one for each component; ./dev package makes them.
set(abi ${PROJECT_VERSION_MAJOR}.${PROJECT_VERSION_MINOR})

set(package_of_library libcairn${abi})
set(section_of_library libs)
set(description_of_library "objects from a rectified stereo pair: shared libraries")

# Apart, so that who links the core alone need not install OpenCV's video and SQLite.
set(package_of_sequences libcairn-sequences${abi})
set(section_of_sequences libs)
set(description_of_sequences "objects from a rectified stereo pair: shared libraries for sequences")

# FFmpeg and GDAL, 200 packages, for those who follow videos.
set(package_of_video cairn-video)
set(section_of_video science)
set(description_of_video "objects from a rectified stereo pair: videos as sequences")

# GStreamer, for those whose cameras it reads.
set(package_of_gstreamer cairn-gstreamer)
set(section_of_gstreamer science)
set(description_of_gstreamer "objects from a rectified stereo pair: cameras by GStreamer")

set(package_of_dev libcairn-dev)
set(section_of_dev libdevel)
set(description_of_dev "objects from a rectified stereo pair: headers for C++20")

set(package_of_tools cairn)
set(section_of_tools science)
set(description_of_tools "objects from a rectified stereo pair: the command, with samples")

set(package_of_python python3-cairn)
set(section_of_python python)
set(description_of_python "objects from a rectified stereo pair: Python 3 module")
# A compiled module belongs to one minor version of Python.
set(CPACK_DEBIAN_PYTHON_PACKAGE_DEPENDS "python3, python3-numpy")
if(Python_VERSION_MINOR OR Python3_VERSION_MINOR)
  set(minor ${Python_VERSION_MINOR}${Python3_VERSION_MINOR})
  math(EXPR next "${minor} + 1")
  set(CPACK_DEBIAN_PYTHON_PACKAGE_DEPENDS "python3 (>= 3.${minor}), python3 (<< 3.${next}), python3-numpy")
endif()

set(CPACK_DEBIAN_PYTHON_PACKAGE_CONTROL_EXTRA ${PROJECT_SOURCE_DIR}/packaging/python/postinst
  ${PROJECT_SOURCE_DIR}/packaging/python/prerm)

set(CPACK_COMPONENTS_ALL)
get_cmake_property(components COMPONENTS)
foreach(component library sequences video gstreamer dev tools python)
  if(NOT component IN_LIST components)
    continue()
  endif()
  list(APPEND CPACK_COMPONENTS_ALL ${component})
  string(TOUPPER ${component} upper)
  set(CPACK_DEBIAN_${upper}_PACKAGE_NAME ${package_of_${component}})
  set(CPACK_DEBIAN_${upper}_PACKAGE_SECTION ${section_of_${component}})
  set(CPACK_COMPONENT_${upper}_DESCRIPTION ${description_of_${component}})
  if(NOT component STREQUAL "library")
    set(CPACK_COMPONENT_${upper}_DEPENDS library)
    if(NOT component STREQUAL "sequences" AND "sequences" IN_LIST components)
      list(APPEND CPACK_COMPONENT_${upper}_DEPENDS sequences)
    endif()
  endif()
  if(CAIRN_DEBIAN)
    install(FILES ${PROJECT_SOURCE_DIR}/packaging/copyright
      DESTINATION ${CMAKE_INSTALL_DATADIR}/doc/${package_of_${component}} COMPONENT ${component})
  endif()
endforeach()
if(CAIRN_DEBIAN)
  install(CODE [[
    file(GLOB pages $ENV{DESTDIR}${CMAKE_INSTALL_PREFIX}/share/man/man[17]/*.[17])
    execute_process(COMMAND gzip -9nf ${pages} COMMAND_ERROR_IS_FATAL ANY)]] COMPONENT tools)
endif()

set(CPACK_GENERATOR DEB)
set(CPACK_PACKAGE_NAME cairn)
set(CPACK_PACKAGE_VENDOR "the cairn authors")
set(CPACK_PACKAGE_CONTACT "the cairn authors <cairn@localhost>")
set(CPACK_PACKAGING_INSTALL_PREFIX ${CMAKE_INSTALL_PREFIX})
set(CPACK_COMPONENTS_GROUPING IGNORE)
set(CPACK_STRIP_FILES ON)
set(CPACK_DEB_COMPONENT_INSTALL ON)
set(CPACK_DEBIAN_FILE_NAME DEB-DEFAULT)
set(CPACK_DEBIAN_ENABLE_COMPONENT_DEPENDS ON)
set(CPACK_DEBIAN_PACKAGE_SHLIBDEPS ON)
# Where the libraries that the command and the module link lie before they are installed.
set(CPACK_DEBIAN_PACKAGE_SHLIBDEPS_PRIVATE_DIRS)
foreach(folder libcairn io tracking landmarks source live)
  list(APPEND CPACK_DEBIAN_PACKAGE_SHLIBDEPS_PRIVATE_DIRS ${PROJECT_BINARY_DIR}/${folder})
endforeach()
set(CPACK_DEBIAN_PACKAGE_GENERATE_SHLIBS ON)
set(CPACK_DEBIAN_PACKAGE_CONTROL_STRICT_PERMISSION ON)
set(CPACK_DEBIAN_LIBRARY_PACKAGE_MULTIARCH same)
set(CPACK_DEBIAN_SEQUENCES_PACKAGE_MULTIARCH same)
if("video" IN_LIST components)
  set(CPACK_DEBIAN_TOOLS_PACKAGE_SUGGESTS ${package_of_video})
endif()
include(CPack)
