add_executable(mirage_gltf_tests
  server/scene/gltf/animation_test.cpp server/scene/gltf/anisotropy_test.cpp server/scene/gltf/compressed_test.cpp
  server/scene/gltf/container_test.cpp server/scene/gltf/detail_frame_test.cpp server/scene/gltf/geometry_test.cpp
  server/scene/gltf/ktx2_test.cpp server/scene/gltf/material_test.cpp
  server/scene/gltf/one_flaw_test.cpp server/scene/gltf/scene_test.cpp server/scene/gltf/staging_test.cpp server/scene/gltf/sweep_test.cpp
  server/scene/gltf/uv_plan_test.cpp)
mirage_target(mirage_gltf_tests TEST)
target_compile_definitions(mirage_gltf_tests PRIVATE MIRAGE_SOURCE_DIR="${PROJECT_SOURCE_DIR}")
target_link_libraries(mirage_gltf_tests PRIVATE mirage_gltf nlohmann_json::nlohmann_json OpenSSL::Crypto
                      GTest::gtest_main ${CMAKE_DL_LIBS})
if(DRACO_FOUND)  # libdraco is linked through mirage_gltf
  target_compile_definitions(mirage_gltf_tests PRIVATE MIRAGE_DRACO)
endif()
mirage_long_unit_test(gltf mirage_gltf_tests)
