# Installs the programs, their manual pages, the service with its user and an example configuration, dashboard and alerts, and
# configurations of HAProxy and nginx.
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

# Writes manual pages, and completions for three shells.
set(texts)
foreach(program ${programs})
  set(folder ${PROJECT_BINARY_DIR}/texts)
  set(made ${folder}/man/${program}.1 ${folder}/bash/${program} ${folder}/zsh/_${program} ${folder}/fish/${program}.fish)
  add_custom_command(
    OUTPUT ${made}
    COMMAND ${CMAKE_COMMAND} -E make_directory ${folder}/man ${folder}/bash ${folder}/zsh ${folder}/fish
    COMMAND ${PROJECT_SOURCE_DIR}/scripts/man $<TARGET_FILE:${program}> > ${folder}/man/${program}.1
    COMMAND ${PROJECT_SOURCE_DIR}/scripts/completion bash $<TARGET_FILE:${program}> > ${folder}/bash/${program}
    COMMAND ${PROJECT_SOURCE_DIR}/scripts/completion zsh $<TARGET_FILE:${program}> > ${folder}/zsh/_${program}
    COMMAND ${PROJECT_SOURCE_DIR}/scripts/completion fish $<TARGET_FILE:${program}> > ${folder}/fish/${program}.fish
    DEPENDS ${program} ${PROJECT_SOURCE_DIR}/scripts/man ${PROJECT_SOURCE_DIR}/scripts/completion
    COMMENT "Writing manual page and completions of ${program}"
    VERBATIM)
  list(APPEND texts ${made})
endforeach()
add_custom_target(texts DEPENDS ${texts})
# Makes them in `install` only, because it runs the programs, and a build may have sanitizers.
install(CODE "execute_process(COMMAND \"${CMAKE_COMMAND}\" --build \"${PROJECT_BINARY_DIR}\" --target texts COMMAND_ERROR_IS_FATAL ANY)")
set(share ${CMAKE_INSTALL_DATADIR})
install(DIRECTORY ${PROJECT_BINARY_DIR}/texts/man/ DESTINATION ${CMAKE_INSTALL_MANDIR}/man1)
install(DIRECTORY ${PROJECT_BINARY_DIR}/texts/bash/ DESTINATION ${share}/bash-completion/completions)
install(DIRECTORY ${PROJECT_BINARY_DIR}/texts/zsh/ DESTINATION ${share}/zsh/vendor-completions)
install(DIRECTORY ${PROJECT_BINARY_DIR}/texts/fish/ DESTINATION ${share}/fish/vendor_completions.d)
install(FILES client/web/site/icon.svg DESTINATION ${share}/icons/hicolor/scalable/apps RENAME mirage.svg)
install(FILES packaging/viewer/mirage-view.desktop DESTINATION ${share}/applications)

# Installs the page for browsers if scripts/web has staged it.
install(DIRECTORY build/web/site/ DESTINATION share/mirage/web OPTIONAL)

install(FILES packaging/systemd/mirage-server.service DESTINATION lib/systemd/system)
install(FILES packaging/systemd/mirage.sysusers.conf DESTINATION lib/sysusers.d RENAME mirage.conf)
install(FILES packaging/server.toml DESTINATION ${CMAKE_INSTALL_DOCDIR}/examples)
install(DIRECTORY packaging/caddy packaging/haproxy packaging/nginx packaging/prometheus packaging/grafana
  DESTINATION ${CMAKE_INSTALL_DOCDIR}/examples)

# `scripts/deb` makes Debian packages; `cpack` packs everything into one archive.
set(CPACK_PACKAGE_NAME mirage)
set(CPACK_GENERATOR TZST)
set(CPACK_STRIP_FILES ON)
include(CPack)
