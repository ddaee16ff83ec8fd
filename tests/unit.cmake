add_executable(mirage_core_tests
  client/ask/codec_choice_test.cpp client/ask/scheduler_test.cpp client/ask/server_pace_test.cpp
  client/ask/answered_keys_test.cpp client/ask/catalogue_test.cpp client/ask/window_test.cpp client/draw/entangled_test.cpp client/draw/geometric_error_test.cpp client/frame/camera_path_test.cpp client/hold/atlas_test.cpp client/hold/cache_test.cpp
  client/hold/light_test.cpp client/hold/mesh_cache_test.cpp client/hold/upload_test.cpp
  client/link/modelled_link_test.cpp client/native/server_url_test.cpp client/native/unpacker_test.cpp client/plan/blend_order_test.cpp client/plan/drawn_pixel_test.cpp client/plan/eight_views_test.cpp
  client/plan/group_test.cpp client/plan/importance_test.cpp client/plan/motion_test.cpp client/plan/opener_test.cpp
  client/plan/parts_test.cpp client/plan/plan_test.cpp client/plan/predictor_test.cpp client/plan/rent_test.cpp
  client/plan/selector_geometry_test.cpp client/plan/selector_test.cpp client/plan/settled_test.cpp
  client/plan/tau_test.cpp client/plan/tile_fit_test.cpp client/price/price_test.cpp client/price/server_work_test.cpp client/price/tile_bytes_test.cpp
  client/host/frame_recorder_test.cpp client/screen/footing_test.cpp client/screen/pilot_test.cpp client/session/ground_test.cpp client/session/session_test.cpp client/session/shadow_test.cpp client/session/stillness_test.cpp
  client/session/playback_test.cpp client/session/view_test.cpp server/base/cache_test.cpp server/base/keeping_test.cpp server/lod/lod_chunks_test.cpp
  server/lod/lod_family_test.cpp server/lod/lod_test.cpp server/lod/seams_test.cpp protocol/base/resources_test.cpp protocol/base/shard_test.cpp protocol/model/view_place_test.cpp protocol/output/zip_test.cpp server/download/download_request_test.cpp server/ground/ground_test.cpp server/net/admission_test.cpp server/net/page_urls_test.cpp server/net/qr_code_test.cpp server/net/forwarded_test.cpp server/net/front_page_test.cpp server/net/oembed_test.cpp server/net/picture_http_test.cpp server/net/tile_http_test.cpp server/net/web_pages_test.cpp server/net/websocket_rules_test.cpp server/prepare/grouping_test.cpp
  server/prepare/hull_test.cpp server/prepare/leave_out_test.cpp server/prepare/leave_out_covered_test.cpp server/prepare/load_test.cpp
  server/prepare/motion_test.cpp server/prepare/parts_test.cpp server/prepare/posed_extent_test.cpp server/prepare/touching_test.cpp
  server/render/shading_test.cpp server/scene/environment/environment_test.cpp server/session/access_test.cpp server/session/asks_test.cpp
  server/session/codec_test.cpp server/session/fetch_test.cpp server/session/gets_test.cpp server/session/session_test.cpp
  server/session/view_test.cpp server/stage/machine_share_test.cpp server/stage/profile_test.cpp server/tile/behind_test.cpp server/tile/bound_test.cpp
  relay/packet_direction.cpp relay/packet_direction_test.cpp relay/shaped_direction.cpp relay/shaped_direction_test.cpp server/tile/impostor_file_test.cpp server/tile/measure_test.cpp server/tile/queue_test.cpp server/tile/store_test.cpp
  shaders/gl/missing_gpu_test.cpp)
mirage_target(mirage_core_tests TEST)
target_compile_definitions(mirage_core_tests PRIVATE MIRAGE_SOURCE_DIR="${PROJECT_SOURCE_DIR}")
target_link_libraries(mirage_core_tests PRIVATE mirage_test_rigs mirage_cli mirage_net mirage_client_native mirage_client_screen mirage_frame_recorder mirage_server_core mirage_ground mirage_gltf mirage_hull mirage_lod mirage_output OpenImageIO::OpenImageIO nlohmann_json::nlohmann_json
                      GTest::gtest_main)
mirage_long_unit_test(core mirage_core_tests)
