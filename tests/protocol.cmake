add_executable(mirage_protocol_tests
  ${PROJECT_SOURCE_DIR}/tests/unit/protocol_animation_test.cpp
  ${PROJECT_SOURCE_DIR}/tests/unit/protocol_error_bound_test.cpp
  ${PROJECT_SOURCE_DIR}/tests/unit/protocol_geometry_test.cpp
  ${PROJECT_SOURCE_DIR}/tests/unit/protocol_hostile_test.cpp
  ${PROJECT_SOURCE_DIR}/tests/unit/protocol_image_test.cpp
  ${PROJECT_SOURCE_DIR}/tests/unit/protocol_lossy_test.cpp
  ${PROJECT_SOURCE_DIR}/tests/unit/protocol_lighting_test.cpp
  ${PROJECT_SOURCE_DIR}/tests/unit/protocol_message_test.cpp
  ${PROJECT_SOURCE_DIR}/tests/unit/protocol_probe_test.cpp
  ${PROJECT_SOURCE_DIR}/tests/unit/protocol_shadow_test.cpp
  ${PROJECT_SOURCE_DIR}/tests/unit/protocol_stable_test.cpp
  ${PROJECT_SOURCE_DIR}/tests/unit/protocol_model_test.cpp
  ${PROJECT_SOURCE_DIR}/tests/unit/protocol_tile_test.cpp
  ${PROJECT_SOURCE_DIR}/tests/unit/protocol_values_test.cpp
  ${PROJECT_SOURCE_DIR}/tests/unit/protocol_view_cell_test.cpp
  ${PROJECT_SOURCE_DIR}/tests/unit/protocol_view_tile_test.cpp
  ${PROJECT_SOURCE_DIR}/tests/unit/protocol_wire_test.cpp)
mirage_target(mirage_protocol_tests TEST)
target_link_libraries(mirage_protocol_tests PRIVATE mirage_protocol GTest::gtest_main)
mirage_unit_test(protocol mirage_protocol_tests)
