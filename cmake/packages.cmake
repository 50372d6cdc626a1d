# cpack -G DEB: one Debian package per component of cmake/install.cmake; run by ./dev package.
set(abi ${PROJECT_VERSION_MAJOR}.${PROJECT_VERSION_MINOR})

set(package_of_library libcairn${abi})
set(section_of_library libs)
set(description_of_library "objects from a rectified stereo pair: shared libraries")

# Separate, so that linking only the core does not require OpenCV's video module and SQLite.
set(package_of_sequences libcairn-sequences${abi})
set(section_of_sequences libs)
set(description_of_sequences "objects from a rectified stereo pair: shared libraries for sequences")

# Separate, since FFmpeg and GDAL are 200 packages.
set(package_of_video cairn-video)
set(section_of_video science)
set(description_of_video "objects from a rectified stereo pair: videos as sequences")

# Separate, for users of GStreamer cameras.
set(package_of_gstreamer cairn-gstreamer)
set(section_of_gstreamer science)
set(description_of_gstreamer "objects from a rectified stereo pair: cameras by GStreamer")
set(CPACK_DEBIAN_GSTREAMER_PACKAGE_DEPENDS gstreamer1.0-plugins-base)
set(CPACK_DEBIAN_GSTREAMER_PACKAGE_RECOMMENDS gstreamer1.0-plugins-good)
set(CPACK_DEBIAN_GSTREAMER_PACKAGE_SUGGESTS "gstreamer1.0-libav, gstreamer1.0-plugins-bad")

set(package_of_ros2 cairn-ros2)
set(section_of_ros2 science)
set(description_of_ros2 "objects from a rectified stereo pair: topics of ROS 2")

set(package_of_vulkan cairn-vulkan)
set(section_of_vulkan science)
set(description_of_vulkan "objects from a rectified stereo pair: matching on graphics processors")
set(CPACK_DEBIAN_VULKAN_PACKAGE_DEPENDS libvulkan1)  # which it opens at run time
set(CPACK_DEBIAN_VULKAN_PACKAGE_RECOMMENDS mesa-vulkan-drivers)

set(package_of_dev libcairn-dev)
set(section_of_dev libdevel)
set(description_of_dev "objects from a rectified stereo pair: headers for C++20")

set(package_of_tools cairn)
set(section_of_tools science)
set(description_of_tools "objects from a rectified stereo pair: the command, with samples")

set(package_of_python python3-cairn)
set(section_of_python python)
set(description_of_python "objects from a rectified stereo pair: Python 3 module")
# A compiled module works with one minor version of Python only.
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
foreach(component library sequences video gstreamer ros2 vulkan dev tools python)
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
    if(pages)
      execute_process(COMMAND gzip -9nf ${pages} COMMAND_ERROR_IS_FATAL ANY)
    endif()]] COMPONENT tools)
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
# Folder of the built libraries that the command and the module link, before installation.
set(CPACK_DEBIAN_PACKAGE_SHLIBDEPS_PRIVATE_DIRS ${PROJECT_BINARY_DIR}/libcairn)
set(CPACK_DEBIAN_PACKAGE_GENERATE_SHLIBS ON)
set(CPACK_DEBIAN_PACKAGE_CONTROL_STRICT_PERMISSION ON)
set(CPACK_DEBIAN_LIBRARY_PACKAGE_MULTIARCH same)
set(CPACK_DEBIAN_SEQUENCES_PACKAGE_MULTIARCH same)
set(suggested)
foreach(component video gstreamer ros2 vulkan)
  if(component IN_LIST components)
    list(APPEND suggested ${package_of_${component}})
  endif()
endforeach()
list(JOIN suggested ", " CPACK_DEBIAN_TOOLS_PACKAGE_SUGGESTS)
include(CPack)
