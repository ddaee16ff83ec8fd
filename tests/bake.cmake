# Bakes without GL: captures of an object made of formulas, exported and read back.
add_executable(mirage_bake_tests
  server/bake/arrows.cpp server/bake/baked.cpp server/bake/consumers.cpp
  server/bake/alpha_field_test.cpp server/bake/boimp_file_test.cpp server/bake/corner_frames_test.cpp
  server/bake/engine_texts_test.cpp server/bake/export_test.cpp server/bake/lattice_test.cpp
  server/bake/read_back_test.cpp server/bake/target_test.cpp)
mirage_target(mirage_bake_tests TEST)
target_link_libraries(mirage_bake_tests PRIVATE mirage_bake nlohmann_json::nlohmann_json GTest::gtest_main)
mirage_unit_test(bake mirage_bake_tests)
