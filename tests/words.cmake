# Documents: the reference is what programs print, and the commands of README and guides work.
mirage_e2e(reference)
add_dependencies(mirage_e2e_reference mirage-token mirage-sheet)

find_package(Python3 COMPONENTS Interpreter)
if(Python3_FOUND)
  add_test(NAME words COMMAND Python3::Interpreter ${PROJECT_SOURCE_DIR}/scripts/lint-words)
  file(GLOB guides CONFIGURE_DEPENDS ${PROJECT_SOURCE_DIR}/docs/guide/*.md)
  add_test(NAME commands_of_guides
           COMMAND Python3::Interpreter ${CMAKE_CURRENT_SOURCE_DIR}/words/commands.py ${PROJECT_BINARY_DIR}/bin
                   ${PROJECT_SOURCE_DIR}/README.md ${guides})
  # The guides' servers listen on the default port, as a reader's do, and those of the packages.
  set_tests_properties(commands_of_guides PROPERTIES TIMEOUT 900 RESOURCE_LOCK default_port)
endif()
add_test(NAME reference_current COMMAND ${PROJECT_SOURCE_DIR}/scripts/reference --check ${PROJECT_BINARY_DIR}/bin)
