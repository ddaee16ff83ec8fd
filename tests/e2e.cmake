# End-to-end tests: the shipped programs over real sockets on loopback.

function(mirage_e2e name)
  add_executable(mirage_e2e_${name} e2e/${name}_test.cpp)
  mirage_target(mirage_e2e_${name} TEST)
  target_link_libraries(mirage_e2e_${name} PRIVATE mirage_test_support nlohmann_json::nlohmann_json
                        GTest::gtest_main)
  add_dependencies(mirage_e2e_${name} mirage-server mirage-view mirage-freeze mirage-load mirage-report mirage-extreme)
  add_test(NAME e2e_${name} COMMAND mirage_e2e_${name})
  set_tests_properties(e2e_${name} PROPERTIES TIMEOUT 900)
endfunction()

# Like mirage_e2e, but the tests of the program are dealt out to several that run side by side.
function(mirage_e2e_shards name shards)
  mirage_e2e(${name})
  set_tests_properties(e2e_${name} PROPERTIES ENVIRONMENT "GTEST_TOTAL_SHARDS=${shards};GTEST_SHARD_INDEX=0")
  math(EXPR last "${shards} - 1")
  foreach(shard RANGE 1 ${last})
    add_test(NAME e2e_${name}_${shard} COMMAND mirage_e2e_${name})
    set_tests_properties(e2e_${name}_${shard} PROPERTIES TIMEOUT 900
      ENVIRONMENT "GTEST_TOTAL_SHARDS=${shards};GTEST_SHARD_INDEX=${shard}")
  endforeach()
endfunction()

mirage_e2e(walk)
mirage_e2e(shadows)
mirage_e2e(failure)
mirage_e2e(load)
mirage_e2e_shards(assets 4)
mirage_e2e(animation)
mirage_e2e(report)
mirage_e2e(stillness)
mirage_e2e(budget)
mirage_e2e(cache)
mirage_e2e(counters)
mirage_e2e(memory)
mirage_e2e(parts)
mirage_e2e(demo)
mirage_e2e(touching)
mirage_e2e(modules)
add_dependencies(mirage_e2e_modules mirage-token mirage-sheet mirage-bench)
mirage_e2e(freeze)
mirage_e2e(options)
mirage_e2e(listen)
target_link_libraries(mirage_e2e_options PRIVATE mirage_cli)
add_dependencies(mirage_e2e_options mirage-bake mirage-token mirage-sheet mirage-bench)
add_dependencies(mirage_e2e_demo mirage-sheet)
target_compile_definitions(mirage_e2e_demo PRIVATE MIRAGE_SOURCE_DIR="${PROJECT_SOURCE_DIR}")
# These tests write their own scenes.
target_link_libraries(mirage_e2e_parts PRIVATE mirage_gltf)
target_link_libraries(mirage_e2e_touching PRIVATE mirage_gltf)
# Tests tiles that servers share, with the shipped servers and with the source itself.
mirage_e2e(shared_store)
target_link_libraries(mirage_e2e_shared_store PRIVATE mirage_source)
# Runs these alone: the server goes on without a store that takes longer than 10 ms, as on a busy machine.
set_tests_properties(e2e_cache e2e_shared_store PROPERTIES RUN_SERIAL ON)
mirage_e2e(relay)
add_dependencies(mirage_e2e_relay mirage-relay mirage-link)
add_dependencies(mirage_e2e_load mirage-relay)
mirage_e2e(operations)
target_compile_definitions(mirage_e2e_operations PRIVATE MIRAGE_SOURCE_DIR="${PROJECT_SOURCE_DIR}")
# The test of reloading writes scenes, compares frames, and uses TLS.
mirage_e2e(reload)
target_link_libraries(mirage_e2e_reload PRIVATE mirage_gltf OpenImageIO::OpenImageIO OpenSSL::SSL)
mirage_e2e(choices)
target_link_libraries(mirage_e2e_choices PRIVATE mirage_gltf OpenImageIO::OpenImageIO)
mirage_e2e(library)
target_sources(mirage_e2e_library PRIVATE e2e/library_views_test.cpp support/failing_memory.cpp)
target_link_libraries(mirage_e2e_library PRIVATE mirage-client mirage_egl OpenImageIO::OpenImageIO)
# The test of posters writes scenes, and compares pixels.
mirage_e2e(posters)
target_link_libraries(mirage_e2e_posters PRIVATE mirage_gltf OpenImageIO::OpenImageIO)
mirage_e2e(pictures)
target_link_libraries(mirage_e2e_pictures PRIVATE mirage-client mirage_egl OpenImageIO::OpenImageIO)
mirage_e2e(bake)
target_link_libraries(mirage_e2e_bake PRIVATE mirage_gltf OpenImageIO::OpenImageIO)
add_dependencies(mirage_e2e_bake mirage-bake)
mirage_e2e(download)
add_dependencies(mirage_e2e_download mirage-bake mirage-freeze)
mirage_e2e(softpipe)
target_link_libraries(mirage_e2e_softpipe PRIVATE mirage_quality OpenImageIO::OpenImageIO)
# Runs alone, because it watches frame times.
set_tests_properties(e2e_failure PROPERTIES RUN_SERIAL ON)

# A library that stands before the driver and the file system of a server. It makes them fail or slow down on command.
add_library(mirage_test_faults MODULE support/faults.cpp)
mirage_target(mirage_test_faults PCH none)
target_link_libraries(mirage_test_faults PRIVATE ${CMAKE_DL_LIBS})
mirage_e2e(faults)
add_dependencies(mirage_e2e_faults mirage_test_faults)
target_compile_definitions(mirage_e2e_faults PRIVATE MIRAGE_FAULTS="$<TARGET_FILE:mirage_test_faults>")
# Runs alone, because it compares waiting times.
set_tests_properties(e2e_faults PROPERTIES RUN_SERIAL ON)

# A library that stands before the driver's compiler: it keeps shaders, or sets what they have not written.
add_library(mirage_test_shaders MODULE support/shader_source.cpp support/undefined_locals.cpp)
mirage_target(mirage_test_shaders PCH none)
target_link_libraries(mirage_test_shaders PRIVATE ${CMAKE_DL_LIBS})
mirage_e2e_shards(shaders 3)
target_sources(mirage_e2e_shaders PRIVATE support/undefined_locals.cpp)
add_dependencies(mirage_e2e_shaders mirage_test_shaders)
target_compile_definitions(mirage_e2e_shaders PRIVATE MIRAGE_SHADERS="$<TARGET_FILE:mirage_test_shaders>")

# Tests the portable bundle of all programs.
set(unpacked ${PROJECT_BINARY_DIR}/unpacked_bundle)
add_test(NAME e2e_bundle COMMAND ${CMAKE_CURRENT_SOURCE_DIR}/e2e/bundle.sh ${CMAKE_RUNTIME_OUTPUT_DIRECTORY} ${unpacked})
set_tests_properties(e2e_bundle PROPERTIES TIMEOUT 600 FIXTURES_SETUP bundle)
# Runs it in a root without libraries. It is skipped where users may not make namespaces.
add_test(NAME e2e_bare_root COMMAND ${CMAKE_CURRENT_SOURCE_DIR}/e2e/bare_root.sh ${unpacked})
set_tests_properties(e2e_bare_root PROPERTIES TIMEOUT 120 SKIP_RETURN_CODE 77 FIXTURES_REQUIRED bundle)
add_test(NAME e2e_bundle_removed COMMAND ${CMAKE_COMMAND} -E rm -rf ${unpacked})
set_tests_properties(e2e_bundle_removed PROPERTIES FIXTURES_CLEANUP bundle)

# Tests the Debian package if the tools to make one are installed.
if(NOT MIRAGE_SANITIZE)
  add_test(NAME e2e_package COMMAND ${CMAKE_CURRENT_SOURCE_DIR}/e2e/package.sh ${PROJECT_BINARY_DIR})
  set_tests_properties(e2e_package PROPERTIES TIMEOUT 300 RESOURCE_LOCK default_port)
  # The client library as others build against it.
  add_test(NAME e2e_embed COMMAND ${CMAKE_CURRENT_SOURCE_DIR}/e2e/embed.sh ${PROJECT_BINARY_DIR} ${PROJECT_SOURCE_DIR})
  set_tests_properties(e2e_embed PROPERTIES TIMEOUT 300)
endif()

# Tests the Python file for notebooks.
find_program(MIRAGE_PYTHON NAMES python3 PATHS /usr/bin NO_DEFAULT_PATH)
if(MIRAGE_PYTHON AND NOT MIRAGE_SANITIZE)
  add_test(NAME e2e_notebook COMMAND ${MIRAGE_PYTHON} ${CMAKE_CURRENT_SOURCE_DIR}/e2e/notebook.py
           $<TARGET_FILE:mirage-server> ${PROJECT_SOURCE_DIR})
  set_tests_properties(e2e_notebook PROPERTIES TIMEOUT 300)
endif()

# Tests an array of jobs under a real Slurm if there is one.
add_test(NAME e2e_slurm COMMAND ${CMAKE_CURRENT_SOURCE_DIR}/e2e/slurm.sh ${CMAKE_RUNTIME_OUTPUT_DIRECTORY})
set_tests_properties(e2e_slurm PROPERTIES TIMEOUT 300 RUN_SERIAL ON)
