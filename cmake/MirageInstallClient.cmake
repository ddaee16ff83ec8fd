# Installs the client library with headers, and what CMake and pkg-config find it by.
include(GNUInstallDirs)
include(CMakePackageConfigHelpers)
set(CMAKE_SKIP_INSTALL_ALL_DEPENDENCY ON)  # installs without building the tests
set(config ${CMAKE_INSTALL_LIBDIR}/cmake/mirage-client)
install(TARGETS mirage-client EXPORT mirage-client LIBRARY DESTINATION ${CMAKE_INSTALL_LIBDIR} COMPONENT client)
install(DIRECTORY client/library/include/mirage DESTINATION ${CMAKE_INSTALL_INCLUDEDIR} COMPONENT client)
if(TARGET mirage_client_archive)
  install(FILES ${PROJECT_BINARY_DIR}/lib/libmirage-client.a DESTINATION ${CMAKE_INSTALL_LIBDIR} COMPONENT client)
endif()
install(EXPORT mirage-client NAMESPACE mirage:: FILE mirage-client-targets.cmake DESTINATION ${config} COMPONENT client)
configure_package_config_file(packaging/client/mirage-client-config.cmake.in ${PROJECT_BINARY_DIR}/mirage-client-config.cmake
  INSTALL_DESTINATION ${config} PATH_VARS CMAKE_INSTALL_LIBDIR CMAKE_INSTALL_INCLUDEDIR)
write_basic_package_version_file(${PROJECT_BINARY_DIR}/mirage-client-config-version.cmake COMPATIBILITY SameMinorVersion)
install(FILES ${PROJECT_BINARY_DIR}/mirage-client-config.cmake ${PROJECT_BINARY_DIR}/mirage-client-config-version.cmake
  DESTINATION ${config} COMPONENT client)
# The file finds its prefix by its own place, so that an installation can be moved.
string(REGEX REPLACE "[^/]+" ".." pc_up ${CMAKE_INSTALL_LIBDIR}/pkgconfig)
configure_file(packaging/client/mirage-client.pc.in ${PROJECT_BINARY_DIR}/mirage-client.pc @ONLY)
install(FILES ${PROJECT_BINARY_DIR}/mirage-client.pc DESTINATION ${CMAKE_INSTALL_LIBDIR}/pkgconfig COMPONENT client)
