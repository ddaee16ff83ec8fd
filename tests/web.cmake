# The page for browsers in a real one; skipped, with a word, where that or the built page is not there.
add_test(NAME web COMMAND ${CMAKE_CURRENT_SOURCE_DIR}/web/run ${PROJECT_BINARY_DIR}/bin)
set_tests_properties(web PROPERTIES TIMEOUT 900 SKIP_RETURN_CODE 77 RUN_SERIAL ON)
