add_executable(mirage_report_tests
  client/report/bytes_test.cpp client/report/calibrate_test.cpp client/report/first_test.cpp
  client/report/real_test.cpp client/report/table_test.cpp client/report/video_test.cpp
  client/report/weather_test.cpp client/report/work_precision_test.cpp)
mirage_target(mirage_report_tests TEST)
target_link_libraries(mirage_report_tests PRIVATE mirage_report_core GTest::gtest_main)
mirage_unit_test(report mirage_report_tests)

# Units of frozen folders: the reader, and what the freezer computes.
add_executable(mirage_freeze_tests client/folder/folder_server_test.cpp client/freeze/freeze_test.cpp)
mirage_target(mirage_freeze_tests TEST)
target_link_libraries(mirage_freeze_tests PRIVATE mirage_freeze_core GTest::gtest_main)
mirage_unit_test(freeze mirage_freeze_tests)
