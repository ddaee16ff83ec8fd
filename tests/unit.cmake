add_executable(mirage_core_tests
  ${PROJECT_SOURCE_DIR}/tests/unit/core_atlas_test.cpp
  ${PROJECT_SOURCE_DIR}/tests/unit/core_cache_test.cpp
  ${PROJECT_SOURCE_DIR}/tests/unit/core_camera_path_test.cpp
  ${PROJECT_SOURCE_DIR}/tests/unit/core_eight_views_test.cpp
  ${PROJECT_SOURCE_DIR}/tests/unit/core_group_test.cpp unit/core_opener_test.cpp unit/core_parts_test.cpp
  ${PROJECT_SOURCE_DIR}/tests/unit/core_importance_test.cpp unit/core_blend_order_test.cpp
  ${PROJECT_SOURCE_DIR}/tests/unit/core_mesh_cache_test.cpp
  ${PROJECT_SOURCE_DIR}/tests/unit/core_light_test.cpp
  ${PROJECT_SOURCE_DIR}/tests/unit/core_modelled_link_test.cpp
  ${PROJECT_SOURCE_DIR}/tests/unit/core_predictor_test.cpp
  ${PROJECT_SOURCE_DIR}/tests/unit/core_scheduler_test.cpp
  ${PROJECT_SOURCE_DIR}/tests/unit/core_codec_choice_test.cpp
  ${PROJECT_SOURCE_DIR}/tests/unit/core_selector_test.cpp unit/core_selector_geometry_test.cpp
  ${PROJECT_SOURCE_DIR}/tests/unit/core_session_test.cpp
  ${PROJECT_SOURCE_DIR}/tests/unit/core_shadow_test.cpp
  ${PROJECT_SOURCE_DIR}/tests/unit/core_stillness_test.cpp
  ${PROJECT_SOURCE_DIR}/tests/unit/core_tau_test.cpp
  ${PROJECT_SOURCE_DIR}/tests/unit/core_window_test.cpp unit/core_view_test.cpp
  ${PROJECT_SOURCE_DIR}/tests/unit/core_tile_bytes_test.cpp unit/core_tile_fit_test.cpp unit/core_server_pace_test.cpp unit/core_settled_test.cpp unit/core_upload_test.cpp unit/core_price_test.cpp unit/core_rent_test.cpp unit/core_plan_test.cpp
  ${PROJECT_SOURCE_DIR}/tests/unit/server_environment_test.cpp
  ${PROJECT_SOURCE_DIR}/tests/unit/server_grouping_test.cpp
  ${PROJECT_SOURCE_DIR}/tests/unit/server_bound_test.cpp
  ${PROJECT_SOURCE_DIR}/tests/unit/server_parts_test.cpp
  ${PROJECT_SOURCE_DIR}/tests/unit/server_hull_test.cpp
  ${PROJECT_SOURCE_DIR}/tests/unit/server_leave_out_test.cpp
  ${PROJECT_SOURCE_DIR}/tests/unit/server_lod_test.cpp
  ${PROJECT_SOURCE_DIR}/tests/unit/server_lod_chunks_test.cpp
  ${PROJECT_SOURCE_DIR}/tests/unit/server_lod_family_test.cpp
  ${PROJECT_SOURCE_DIR}/tests/unit/core_motion_test.cpp
  ${PROJECT_SOURCE_DIR}/tests/unit/server_motion_test.cpp
  ${PROJECT_SOURCE_DIR}/tests/unit/server_posed_extent_test.cpp
  ${PROJECT_SOURCE_DIR}/tests/unit/server_codec_test.cpp
  ${PROJECT_SOURCE_DIR}/tests/unit/server_queue_test.cpp
  ${PROJECT_SOURCE_DIR}/tests/unit/server_seams_test.cpp
  ${PROJECT_SOURCE_DIR}/tests/unit/server_shading_test.cpp
  ${PROJECT_SOURCE_DIR}/tests/unit/server_session_test.cpp unit/server_asks_test.cpp unit/server_view_test.cpp unit/server_fetch_test.cpp unit/server_profile_test.cpp
  ${PROJECT_SOURCE_DIR}/tests/unit/server_measure_test.cpp unit/server_behind_test.cpp
  ${PROJECT_SOURCE_DIR}/tests/unit/server_store_test.cpp unit/server_cache_test.cpp unit/server_load_test.cpp)
mirage_target(mirage_core_tests TEST)
target_compile_definitions(mirage_core_tests PRIVATE MIRAGE_SOURCE_DIR="${PROJECT_SOURCE_DIR}")
target_link_libraries(mirage_core_tests PRIVATE mirage_test_rigs mirage_client_core mirage_server_core mirage_gltf mirage_hull mirage_lod OpenImageIO::OpenImageIO nlohmann_json::nlohmann_json
                      GTest::gtest_main)
mirage_unit_test(core mirage_core_tests)
