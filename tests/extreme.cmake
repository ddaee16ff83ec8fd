# The stiff and extreme cases of docs/numerics.md section 6. mirage-report runs the same program.
add_executable(mirage-extreme
  extreme/main.cpp extreme/registry.cpp extreme/extreme_case.cpp extreme/child_run.cpp
  extreme/studio.cpp extreme/shapes.cpp
  extreme/geometry_cases.cpp extreme/geometry_vertex_cases.cpp extreme/geometry_file_cases.cpp
  extreme/prediction_cases.cpp extreme/texture_cases.cpp
  extreme/control_cases.cpp extreme/control_turn_case.cpp extreme/network_cases.cpp extreme/network_server_case.cpp
  extreme/wire_samples.cpp extreme/peak_memory.cpp extreme/wire_cases.cpp extreme/wire_server_cases.cpp
  extreme/view_cases.cpp extreme/view_bound_cases.cpp
  extreme/lighting_cases.cpp extreme/light_pictures.cpp extreme/light_queue_case.cpp
  extreme/alpha_cases.cpp extreme/depth_cases.cpp)
mirage_target(mirage-extreme TEST PCH wire)
target_compile_definitions(mirage-extreme PRIVATE MIRAGE_SOURCE_DIR="${PROJECT_SOURCE_DIR}")
target_link_libraries(mirage-extreme PRIVATE mirage_test_support mirage_test_rigs mirage_server_core mirage_client_core mirage_client_native
                      mirage_gltf mirage_quality mirage_cli nlohmann_json::nlohmann_json)
# Cases about whole programs run these two.
add_dependencies(mirage-extreme mirage-server mirage-view)

# Adds one test for each letter, in the quick form; together they use all cores.
foreach(letter G V L A D T N P C R)
  add_test(NAME extreme_${letter} COMMAND mirage-extreme --quick --only ${letter})
  set_tests_properties(extreme_${letter} PROPERTIES TIMEOUT 900)
endforeach()
