add_executable(mirage_report_tests
  ${PROJECT_SOURCE_DIR}/tests/unit/report_table_test.cpp
  ${PROJECT_SOURCE_DIR}/tests/unit/report_video_test.cpp
  ${PROJECT_SOURCE_DIR}/tests/unit/report_weather_test.cpp
  ${PROJECT_SOURCE_DIR}/tests/unit/report_first_test.cpp
  ${PROJECT_SOURCE_DIR}/tests/unit/report_bytes_test.cpp
  ${PROJECT_SOURCE_DIR}/tests/unit/report_calibrate_test.cpp
  ${PROJECT_SOURCE_DIR}/tests/unit/report_work_precision_test.cpp)
mirage_target(mirage_report_tests TEST)
target_link_libraries(mirage_report_tests PRIVATE mirage_report_core GTest::gtest_main)
mirage_unit_test(report mirage_report_tests)
