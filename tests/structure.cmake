# Tests the shape of the code itself.
add_test(NAME include_directions COMMAND ${CMAKE_COMMAND} -DROOT=${PROJECT_SOURCE_DIR}
         -P ${CMAKE_CURRENT_SOURCE_DIR}/structure/include_directions.cmake)

add_executable(mirage_structure_tests structure/types_test.cpp structure/includes_test.cpp structure/sizes_test.cpp
  structure/top_level_test.cpp)
mirage_target(mirage_structure_tests TEST)
target_compile_definitions(mirage_structure_tests PRIVATE MIRAGE_SOURCE_DIR="${PROJECT_SOURCE_DIR}")
target_link_libraries(mirage_structure_tests PRIVATE GTest::gtest_main)
mirage_unit_test(structure mirage_structure_tests)
