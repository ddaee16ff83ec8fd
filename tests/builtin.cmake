add_executable(mirage_builtin_tests
  server/scene/builtin/mesh_test.cpp server/scene/builtin/museum_test.cpp server/scene/builtin/options_test.cpp
  server/scene/builtin/scene_test.cpp)
mirage_target(mirage_builtin_tests TEST)
target_link_libraries(mirage_builtin_tests PRIVATE mirage_builtin GTest::gtest_main)
mirage_unit_test(builtin mirage_builtin_tests)

# People who walk through whole scenes; too long for the build with sanitizers.
add_executable(mirage_walkers_tests server/ground/walkers_test.cpp)
mirage_target(mirage_walkers_tests TEST)
target_link_libraries(mirage_walkers_tests PRIVATE mirage_client_screen mirage_ground mirage_builtin GTest::gtest_main)
add_test(NAME walkers COMMAND mirage_walkers_tests)
