add_executable(mirage_builtin_tests
  server/scene/builtin/mesh_test.cpp server/scene/builtin/museum_test.cpp server/scene/builtin/options_test.cpp
  server/scene/builtin/scene_test.cpp)
mirage_target(mirage_builtin_tests TEST)
target_link_libraries(mirage_builtin_tests PRIVATE mirage_builtin GTest::gtest_main)
mirage_unit_test(builtin mirage_builtin_tests)
