# The shape of the code itself.
add_test(NAME include_directions COMMAND ${CMAKE_COMMAND} -DROOT=${PROJECT_SOURCE_DIR}
         -P ${CMAKE_CURRENT_SOURCE_DIR}/structure/include_directions.cmake)

add_executable(mirage_structure_tests structure/types_test.cpp structure/includes_test.cpp)
mirage_target(mirage_structure_tests)
target_compile_definitions(mirage_structure_tests PRIVATE MIRAGE_SOURCE_DIR="${PROJECT_SOURCE_DIR}")
target_link_libraries(mirage_structure_tests PRIVATE GTest::gtest_main)
add_test(NAME structure COMMAND mirage_structure_tests)

# The portable core must also compile as C++17 with clang, as a browser build will.
find_program(CLANGXX NAMES clang++ clang++-14)
if(CLANGXX)
  file(GLOB core_sources ${PROJECT_SOURCE_DIR}/client/core/*.cpp ${PROJECT_SOURCE_DIR}/client/price/*.cpp
       ${PROJECT_SOURCE_DIR}/client/plan/*.cpp ${PROJECT_SOURCE_DIR}/protocol/*.cpp)
  list(FILTER core_sources EXCLUDE REGEX "protocol/cli.cpp$")  # of programs
  add_test(NAME portable_core COMMAND ${CLANGXX} -std=c++17 -Wall -Wextra -Werror -fsyntax-only
           -I${PROJECT_SOURCE_DIR} -isystem ${PROJECT_BINARY_DIR}/generated ${core_sources})
else()
  message(STATUS "clang++ not found: the portable core is not checked with it")
endif()
