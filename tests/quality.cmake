add_executable(mirage_quality_tests
  protocol/quality/flip_test.cpp protocol/quality/metrics_test.cpp)
mirage_target(mirage_quality_tests TEST)
target_compile_definitions(mirage_quality_tests PRIVATE MIRAGE_SOURCE_DIR="${PROJECT_SOURCE_DIR}")
target_link_libraries(mirage_quality_tests PRIVATE mirage_quality OpenImageIO::OpenImageIO
                      GTest::gtest_main)
mirage_unit_test(quality mirage_quality_tests)
