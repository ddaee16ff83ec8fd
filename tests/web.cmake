# Tests the page in a real browser. The test is skipped, and says so, without a browser or a built page.
add_test(NAME web COMMAND ${CMAKE_CURRENT_SOURCE_DIR}/web/run ${PROJECT_BINARY_DIR}/bin)
set_tests_properties(web PROPERTIES TIMEOUT 1200 SKIP_RETURN_CODE 77 RUN_SERIAL ON)
