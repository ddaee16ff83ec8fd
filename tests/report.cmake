add_executable(mirage_report_tests
  ${PROJECT_SOURCE_DIR}/tests/unit/report_table_test.cpp
  ${PROJECT_SOURCE_DIR}/tests/unit/report_video_test.cpp
  ${PROJECT_SOURCE_DIR}/tests/unit/report_weather_test.cpp
  ${PROJECT_SOURCE_DIR}/tests/unit/report_first_test.cpp
  ${PROJECT_SOURCE_DIR}/tests/unit/report_bytes_test.cpp
  ${PROJECT_SOURCE_DIR}/tests/unit/report_calibrate_test.cpp
  ${PROJECT_SOURCE_DIR}/tests/unit/report_work_precision_test.cpp)
mirage_target(mirage_report_tests)
target_link_libraries(mirage_report_tests PRIVATE mirage_report_core GTest::gtest_main)
add_test(NAME report COMMAND mirage_report_tests)
