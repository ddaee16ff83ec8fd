add_executable(mirage_protocol_tests
  protocol/base/order_test.cpp protocol/base/stable_test.cpp protocol/codec/animation_test.cpp protocol/codec/atlas_planes_test.cpp protocol/codec/geometry_test.cpp
  protocol/codec/image_test.cpp protocol/codec/lossy_test.cpp protocol/codec/model_test.cpp
  protocol/codec/tile_test.cpp protocol/impostor/error_bound_test.cpp protocol/impostor/lighting_test.cpp
  protocol/impostor/home_pose_test.cpp protocol/impostor/probe_test.cpp protocol/impostor/shadow_test.cpp protocol/impostor/values_test.cpp
  protocol/impostor/view_cell_test.cpp protocol/wire/hostile_test.cpp protocol/wire/message_test.cpp protocol/wire/unpack_test.cpp
  protocol/wire/view_tile_test.cpp protocol/wire/wire_test.cpp)
mirage_target(mirage_protocol_tests TEST)
target_link_libraries(mirage_protocol_tests PRIVATE mirage_wire GTest::gtest_main)
mirage_unit_test(protocol mirage_protocol_tests)
