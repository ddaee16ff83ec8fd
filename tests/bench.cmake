# Benchmarks: costs beside floors and peers. scripts/bench runs them.
add_executable(mirage-bench
  bench/main.cpp bench/bench.cpp bench/selection_bench.cpp bench/tile_bench.cpp bench/store_bench.cpp
  bench/startup_bench.cpp bench/latency_bench.cpp bench/codec_bench.cpp bench/client_bench.cpp bench/price_bench.cpp bench/bench_client.cpp bench/gpu_bench.cpp
  bench/drawn_tiles.cpp bench/server_path.cpp)
mirage_target(mirage-bench PCH wire)
target_link_libraries(mirage-bench PRIVATE mirage_test_support mirage_test_rigs mirage_report_core mirage_server_core mirage_client_core
                      mirage_client_native mirage_load_clients mirage_client_host mirage_quality mirage_gltf mirage_cli nlohmann_json::nlohmann_json)
add_dependencies(mirage-bench mirage-server mirage-load)

# Runs on a graphics card if there is one: ctest -L gpu. The second test runs the same code without a card.
add_test(NAME gpu COMMAND mirage-bench --only gpu)
set_tests_properties(gpu PROPERTIES LABELS gpu SKIP_RETURN_CODE 77 TIMEOUT 900 RUN_SERIAL ON)
add_test(NAME gpu_bench_without_card COMMAND mirage-bench --only gpu --quick --software)
set_tests_properties(gpu_bench_without_card PROPERTIES TIMEOUT 300)
