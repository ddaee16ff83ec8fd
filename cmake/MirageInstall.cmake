# Installs the programs, their manual pages, the service with its user and an example configuration, dashboard and alerts, and
# configurations of HAProxy and nginx.
set(programs mirage-server mirage-view mirage-freeze mirage-load mirage-token mirage-report mirage-sheet mirage-bake)
install(TARGETS ${programs} RUNTIME DESTINATION ${CMAKE_INSTALL_BINDIR})
install(TARGETS mirage_images LIBRARY DESTINATION lib/mirage)
if(TARGET mirage_ktx2)
  install(TARGETS mirage_ktx2 LIBRARY DESTINATION lib/mirage)
endif()
if(TARGET mirage_video)
  install(TARGETS mirage_video LIBRARY DESTINATION lib/mirage)
endif()

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

# Installs the Python file for notebooks.
install(FILES packaging/python/mirage.py DESTINATION share/mirage/python)

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
