add_executable(mirage_builtin_tests
  ${PROJECT_SOURCE_DIR}/tests/unit/builtin_mesh_test.cpp
  ${PROJECT_SOURCE_DIR}/tests/unit/builtin_museum_test.cpp
  ${PROJECT_SOURCE_DIR}/tests/unit/builtin_options_test.cpp
  ${PROJECT_SOURCE_DIR}/tests/unit/builtin_scene_test.cpp)
mirage_target(mirage_builtin_tests TEST)
target_link_libraries(mirage_builtin_tests PRIVATE mirage_builtin GTest::gtest_main)
mirage_unit_test(builtin mirage_builtin_tests)
