# Helpers of several tests and benchmarks: a child process, an object in a GL context, a session with its server, large scenes.
add_library(mirage_test_support STATIC support/process.cpp)
mirage_target(mirage_test_support TEST PCH none)
target_compile_definitions(mirage_test_support PRIVATE MIRAGE_SOURCE_DIR="${PROJECT_SOURCE_DIR}")

add_library(mirage_test_rigs STATIC gl/bench.cpp support/rig.cpp support/large_scene.cpp support/measure_reference.cpp)
mirage_target(mirage_test_rigs PCH wire)
target_compile_definitions(mirage_test_rigs PRIVATE MIRAGE_SOURCE_DIR="${PROJECT_SOURCE_DIR}")
target_link_libraries(mirage_test_rigs PRIVATE mirage_modules PUBLIC mirage_server_core mirage_client_core mirage_gltf mirage_builtin mirage_quality
                      mirage_egl nlohmann_json::nlohmann_json)

# mirage-relay shapes a real TCP connection as a link.
add_executable(mirage-relay relay/main.cpp relay/shaped_direction.cpp)
mirage_target(mirage-relay TEST PCH none)
target_link_libraries(mirage-relay PRIVATE mirage_cli)
# mirage-link also loses packets; its user must be allowed to make network namespaces.
add_executable(mirage-link relay/link_main.cpp relay/packet_direction.cpp)
mirage_target(mirage-link TEST PCH none)
target_link_libraries(mirage-link PRIVATE mirage_cli nlohmann_json::nlohmann_json)
