# Tests of drawing, on any GL driver (llvmpipe will do).
add_executable(mirage_gl_tests gl/leak_listener.cpp gl/fidelity_test.cpp gl/geometry_test.cpp gl/ground_test.cpp gl/stroke_test.cpp gl/tone_test.cpp gl/relief_test.cpp gl/shader_test.cpp gl/light_test.cpp gl/probe_test.cpp gl/anisotropy_test.cpp gl/needs_test.cpp gl/shadow_test.cpp gl/slices_test.cpp gl/view_test.cpp gl/atlas_test.cpp gl/blended_test.cpp gl/layers_test.cpp gl/refinement_test.cpp gl/load_test.cpp gl/measure_test.cpp gl/paced_draw_test.cpp gl/tint_test.cpp gl/door_test.cpp bench/drawn_tiles.cpp)
mirage_target(mirage_gl_tests TEST)
target_compile_definitions(mirage_gl_tests PRIVATE MIRAGE_SOURCE_DIR="${PROJECT_SOURCE_DIR}")
target_link_libraries(mirage_gl_tests PRIVATE mirage_test_rigs mirage_server_core mirage_client_door mirage_quality nlohmann_json::nlohmann_json
                      GTest::gtest_main)
add_test(NAME gl COMMAND mirage_gl_tests)
