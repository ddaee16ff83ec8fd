# Tests the page in a real browser: what a person does with it, then the rest. They are skipped, and say so, without a browser or a
# built page.
add_test(NAME web COMMAND ${CMAKE_CURRENT_SOURCE_DIR}/web/run ${PROJECT_BINARY_DIR}/bin page)
add_test(NAME web_parts COMMAND ${CMAKE_CURRENT_SOURCE_DIR}/web/run ${PROJECT_BINARY_DIR}/bin others)
set_tests_properties(web web_parts PROPERTIES TIMEOUT 1200 SKIP_RETURN_CODE 77 RUN_SERIAL ON)
