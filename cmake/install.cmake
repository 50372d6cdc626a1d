# What `cmake --install` puts in place: the core library with its headers, and the command.
# The io library stays inside: its types are the project's own business until they have settled.
include(GNUInstallDirs)
include(CMakePackageConfigHelpers)

install(TARGETS cairn EXPORT cairn)
install(DIRECTORY cairn/ DESTINATION ${CMAKE_INSTALL_INCLUDEDIR}/cairn FILES_MATCHING
  PATTERN "*.hpp"
  PATTERN "*-inl.hpp" EXCLUDE)
if(CAIRN_IO)
  install(TARGETS cairn_cli)
  install(FILES docs/schema/objects.schema.json DESTINATION ${CMAKE_INSTALL_DATADIR}/cairn)
endif()

set(package_dir ${CMAKE_INSTALL_LIBDIR}/cmake/cairn)
install(EXPORT cairn NAMESPACE cairn:: FILE cairnTargets.cmake DESTINATION ${package_dir})
configure_package_config_file(cmake/cairnConfig.cmake.in cairnConfig.cmake INSTALL_DESTINATION ${package_dir})
write_basic_package_version_file(cairnConfigVersion.cmake COMPATIBILITY SameMinorVersion)
install(FILES ${CMAKE_CURRENT_BINARY_DIR}/cairnConfig.cmake ${CMAKE_CURRENT_BINARY_DIR}/cairnConfigVersion.cmake
  DESTINATION ${package_dir})
