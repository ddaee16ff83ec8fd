# Installs the programs, their manual pages, the service with its user and an example configuration, dashboard and alerts, and
# configurations of HAProxy and nginx. `cpack -G DEB` in the build folder makes a package of them.
include(GNUInstallDirs)
set(CMAKE_SKIP_INSTALL_ALL_DEPENDENCY ON)  # installs programs without building the tests
set(programs mirage-server mirage-view mirage-load mirage-token mirage-report mirage-sheet)
install(TARGETS ${programs} RUNTIME DESTINATION ${CMAKE_INSTALL_BINDIR})
install(TARGETS mirage_images LIBRARY DESTINATION lib/mirage)
if(TARGET mirage_ktx2)
  install(TARGETS mirage_ktx2 LIBRARY DESTINATION lib/mirage)
endif()
if(TARGET mirage_video)
  install(TARGETS mirage_video LIBRARY DESTINATION lib/mirage)
endif()

# Installs the client library with headers, and what CMake and pkg-config find it by.
include(CMakePackageConfigHelpers)
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

set(manuals)
foreach(program ${programs})
  set(manual ${PROJECT_BINARY_DIR}/man/${program}.1)
  add_custom_command(
    OUTPUT ${manual}
    COMMAND ${CMAKE_COMMAND} -E make_directory ${PROJECT_BINARY_DIR}/man
    COMMAND ${PROJECT_SOURCE_DIR}/scripts/man $<TARGET_FILE:${program}> > ${manual}
    DEPENDS ${program} ${PROJECT_SOURCE_DIR}/scripts/man
    COMMENT "Writing ${program}.1"
    VERBATIM)
  list(APPEND manuals ${manual})
endforeach()
add_custom_target(manuals DEPENDS ${manuals})
# Makes manual pages in `install` and `package` only, because it runs the programs, and a build may have sanitizers.
install(CODE "execute_process(COMMAND \"${CMAKE_COMMAND}\" --build \"${PROJECT_BINARY_DIR}\" --target manuals COMMAND_ERROR_IS_FATAL ANY)")
install(FILES ${manuals} DESTINATION ${CMAKE_INSTALL_MANDIR}/man1)

# Installs the page for browsers if scripts/web has staged it.
install(DIRECTORY build/web/site/ DESTINATION share/mirage/web OPTIONAL)

install(FILES packaging/systemd/mirage-server.service DESTINATION lib/systemd/system)
install(FILES packaging/systemd/mirage.sysusers.conf DESTINATION lib/sysusers.d RENAME mirage.conf)
install(FILES packaging/server.toml DESTINATION ${CMAKE_INSTALL_DOCDIR}/examples)
install(DIRECTORY packaging/caddy packaging/haproxy packaging/nginx packaging/prometheus packaging/grafana
  DESTINATION ${CMAKE_INSTALL_DOCDIR}/examples)

set(CPACK_PACKAGE_NAME mirage)
set(CPACK_PACKAGE_CONTACT "The developers of Mirage <mirage@localhost>")
set(CPACK_PACKAGE_DESCRIPTION_SUMMARY "Remote impostor generator: render server, thin viewer, load client")
set(CPACK_PACKAGING_INSTALL_PREFIX /usr)
set(CPACK_STRIP_FILES ON)
set(CPACK_DEBIAN_FILE_NAME DEB-DEFAULT)
set(CPACK_DEBIAN_PACKAGE_SHLIBDEPS ON)
# Names the drivers here, because programs find them at run time and no library names them.
set(CPACK_DEBIAN_PACKAGE_DEPENDS "libgl1-mesa-dri, libegl1")
set(CPACK_DEBIAN_PACKAGE_SUGGESTS "gnuplot-nox, redis-server, haproxy, nginx, prometheus")
set(CPACK_DEBIAN_PACKAGE_SECTION graphics)
set(CPACK_DEBIAN_PACKAGE_CONTROL_EXTRA ${PROJECT_SOURCE_DIR}/packaging/debian/postinst)
set(CPACK_DEBIAN_PACKAGE_CONTROL_STRICT_PERMISSION ON)
include(CPack)
