# What things cost beside floors and peers; scripts/bench runs it.
add_executable(mirage-bench
  bench/main.cpp bench/bench.cpp bench/selection_bench.cpp bench/tile_bench.cpp bench/store_bench.cpp
  bench/startup_bench.cpp bench/latency_bench.cpp bench/codec_bench.cpp bench/client_bench.cpp support/rig.cpp support/large_scene.cpp)
mirage_target(mirage-bench)
target_link_libraries(mirage-bench PRIVATE mirage_test_support mirage_report_core mirage_server_core mirage_client_core
                      mirage_client_native mirage_client_host mirage_quality mirage_gltf CLI11::CLI11 nlohmann_json::nlohmann_json
                      OpenImageIO::OpenImageIO)
add_dependencies(mirage-bench mirage-server mirage-load)
