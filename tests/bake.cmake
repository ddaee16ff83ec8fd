# Bakes without GL: captures of an object made of formulas, exported and read back.
add_executable(mirage_bake_tests
  server/bake/arrows.cpp server/bake/baked.cpp server/bake/consumers.cpp server/bake/read_back_test.cpp)
mirage_target(mirage_bake_tests TEST)
target_link_libraries(mirage_bake_tests PRIVATE mirage_bake GTest::gtest_main)
mirage_unit_test(bake mirage_bake_tests)
