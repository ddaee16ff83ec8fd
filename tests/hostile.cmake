# Tests hostile peers: they send raw bytes to the shipped server, beside a well-behaved client.
add_executable(mirage_hostile_tests
  hostile/before_hello_test.cpp hostile/drain_test.cpp hostile/fairness_test.cpp hostile/framing_test.cpp
  hostile/framing_table.cpp hostile/handshake_test.cpp hostile/memory_cap_test.cpp hostile/origin_test.cpp hostile/outbox_test.cpp
  hostile/page_reader_test.cpp hostile/patience_test.cpp hostile/beside.cpp hostile/client.cpp hostile/web_socket.cpp)
mirage_target(mirage_hostile_tests TEST)
target_link_libraries(mirage_hostile_tests PRIVATE mirage_test_support mirage_wire mirage_impostor GTest::gtest_main)
add_dependencies(mirage_hostile_tests mirage-server)
add_test(NAME e2e_hostile_peers COMMAND mirage_hostile_tests)
# Runs alone, because it times tiles.
set_tests_properties(e2e_hostile_peers PROPERTIES LABELS e2e TIMEOUT 300 RUN_SERIAL ON)
