add_executable(mirage_gltf_tests
  ${PROJECT_SOURCE_DIR}/tests/unit/gltf_animation_test.cpp
  ${PROJECT_SOURCE_DIR}/tests/unit/gltf_anisotropy_test.cpp
  ${PROJECT_SOURCE_DIR}/tests/unit/gltf_compressed_test.cpp
  ${PROJECT_SOURCE_DIR}/tests/unit/gltf_container_test.cpp
  ${PROJECT_SOURCE_DIR}/tests/unit/gltf_geometry_test.cpp
  ${PROJECT_SOURCE_DIR}/tests/unit/gltf_material_test.cpp
  ${PROJECT_SOURCE_DIR}/tests/unit/gltf_scene_test.cpp
  ${PROJECT_SOURCE_DIR}/tests/unit/gltf_sweep_test.cpp)
mirage_target(mirage_gltf_tests TEST)
target_compile_definitions(mirage_gltf_tests PRIVATE MIRAGE_SOURCE_DIR="${PROJECT_SOURCE_DIR}")
target_link_libraries(mirage_gltf_tests PRIVATE mirage_gltf nlohmann_json::nlohmann_json
                     
                      GTest::gtest_main ${CMAKE_DL_LIBS})
if(DRACO_FOUND)  # comes with mirage_gltf
  target_compile_definitions(mirage_gltf_tests PRIVATE MIRAGE_DRACO)
endif()
mirage_unit_test(gltf mirage_gltf_tests)
