# Gives every target the same warnings, standard and sanitizers, without global flags.

# mirage_target(NAME [PORTABLE] [SMALL] [COLD] [TEST] [PCH base|wire|none])
#   PORTABLE   keeps to C++17, for code that also builds for a browser
#   SMALL      in a browser, its bytes count more than its speed
#   COLD       runs seldom, so its bytes count more than its speed everywhere; it has no precompiled header
#   TEST       optimises little, because compiling tests takes longer than running them
#   PCH        names the precompiled header of cmake/pch (default: tests for TEST, else base)
function(mirage_target name)
  cmake_parse_arguments(ARG "PORTABLE;SMALL;COLD;TEST" "PCH" "" ${ARGN})
  if(ARG_PORTABLE)
    target_compile_features(${name} PUBLIC cxx_std_17)
    set_target_properties(${name} PROPERTIES CXX_STANDARD 17)
  else()
    target_compile_features(${name} PUBLIC cxx_std_20)
    set_target_properties(${name} PROPERTIES CXX_STANDARD 20)
  endif()
  target_include_directories(${name} PUBLIC ${PROJECT_SOURCE_DIR} ${PROJECT_BINARY_DIR})
  target_compile_definitions(${name} PRIVATE MIRAGE_VERSION="${PROJECT_VERSION}")
  target_compile_options(${name} PRIVATE -Wall -Wextra -Wpedantic -Wshadow -Wconversion
                         -Wno-sign-conversion -Werror
                         # Loops that shall become vectors have no && and no if.
                         $<$<CXX_COMPILER_ID:Clang>:-Wno-bitwise-instead-of-logical>
                         $<$<CXX_COMPILER_ID:Clang>:-Wno-bitwise-conditional-parentheses>
                         # libstdc++ calls what it deprecates itself (std::stable_sort).
                         $<$<CXX_COMPILER_ID:Clang>:-Wno-deprecated-declarations>
                         $<$<CXX_COMPILER_ID:GNU>:-Wno-restrict>  # false alarms of GCC 12 on std::string
                         -fno-math-errno)
  if(EMSCRIPTEN)
    target_compile_options(${name} PRIVATE -fno-exceptions -fno-rtti)
    # Inlining as eagerly as usual makes the program a tenth larger, and no faster.
    if(ARG_SMALL)
      target_compile_options(${name} PRIVATE -Os)
    else()
      target_compile_options(${name} PRIVATE "SHELL:-mllvm -inline-threshold=30")
    endif()
    return()
  endif()
  # The client is a shared library as well (client/library). Nobody replaces its functions from outside.
  target_compile_options(${name} PRIVATE -fPIC -fno-semantic-interposition)
  # Finds a bundle's libraries beside its programs (scripts/bundle). The old tag also serves libraries of libraries.
  set_target_properties(${name} PROPERTIES BUILD_RPATH "$ORIGIN/../lib")
  get_target_property(kind ${name} TYPE)
  if(kind MATCHES "EXECUTABLE|MODULE")
    target_link_options(${name} PRIVATE -Wl,--disable-new-dtags)
  endif()
  if(CMAKE_BUILD_TYPE STREQUAL "Release" AND NOT MIRAGE_SANITIZE)  # hardening against hostile bytes
    target_compile_options(${name} PRIVATE -fstack-protector-strong -U_FORTIFY_SOURCE -D_FORTIFY_SOURCE=3)
    target_link_options(${name} PRIVATE -Wl,-z,relro,-z,now)
  endif()
  if(MIRAGE_SANITIZE)
    # GCC 12 sees uninitialised members in std::variant once sanitizers instrument it.
    target_compile_options(${name} PRIVATE $<$<CXX_COMPILER_ID:GNU>:-Wno-maybe-uninitialized>)
    target_compile_options(${name} PUBLIC -fsanitize=${MIRAGE_SANITIZE} -fno-omit-frame-pointer)
    target_link_options(${name} PUBLIC -fsanitize=${MIRAGE_SANITIZE})
    if(MIRAGE_SANITIZE MATCHES "undefined")
      target_compile_options(${name} PUBLIC -fno-sanitize-recover=undefined)
    endif()
  endif()
  if(ARG_TEST)
    target_compile_options(${name} PRIVATE $<$<CONFIG:Release>:-O1>)
  endif()
  if(ARG_COLD)
    target_compile_options(${name} PRIVATE $<$<CONFIG:Release>:-Os>)
    set(ARG_PCH none)
  endif()
  # A batch reads headers and instantiates templates once for its files. Shipped code is compiled file by file, unless
  # sanitizers make that slow, or MIRAGE_ALL_BATCHES is on.
  if(MIRAGE_BATCHES AND (ARG_TEST OR MIRAGE_SANITIZE OR MIRAGE_ALL_BATCHES))
    # The files of one folder are a batch, so a new file never brings other files together.
    set_target_properties(${name} PROPERTIES UNITY_BUILD ON UNITY_BUILD_MODE GROUP)
    get_target_property(sources ${name} SOURCES)
    foreach(source IN LISTS sources)
      get_filename_component(folder ${source} DIRECTORY)
      string(MAKE_C_IDENTIFIER "batch_${folder}" batch)
      set_source_files_properties(${source} PROPERTIES UNITY_GROUP ${batch})
    endforeach()
    # These warn of neighbours in a batch. The linter looks at each shipped file alone.
    target_compile_options(${name} PRIVATE -Wno-shadow $<$<CXX_COMPILER_ID:GNU>:-Wno-subobject-linkage>)
  endif()
  if(MIRAGE_PCH AND NOT ARG_PCH STREQUAL "none")
    set(pch base)
    if(ARG_PCH)
      set(pch ${ARG_PCH})
    elseif(ARG_TEST)
      set(pch tests)
    endif()
    if(ARG_PORTABLE)
      string(APPEND pch _portable)
    endif()
    target_precompile_headers(${name} REUSE_FROM mirage_pch_${pch})
    # Silences more false alarms of GCC 12 on std::string: GCC no longer ignores system headers that come from a precompiled
    # header. Builds without precompiled headers still warn.
    target_compile_options(${name} PRIVATE $<$<CXX_COMPILER_ID:GNU>:-Wno-array-bounds>
                           $<$<CXX_COMPILER_ID:GNU>:-Wno-stringop-overflow>)
  endif()
endfunction()

# Adds a module: a library that programs load at first need (modules/module.h). It lies beside them and needs headers of ours only.
function(mirage_module name)
  add_library(${name} MODULE ${ARGN})
  mirage_target(${name} PCH none)
  set_target_properties(${name} PROPERTIES LIBRARY_OUTPUT_DIRECTORY ${CMAKE_RUNTIME_OUTPUT_DIRECTORY}
                        CXX_VISIBILITY_PRESET hidden VISIBILITY_INLINES_HIDDEN ON)
endfunction()

# Compiles each precompiled header once, with the flags of the targets that use it.
function(mirage_precompiled_headers)
  if(NOT EXISTS ${PROJECT_BINARY_DIR}/pch.cpp)
    file(WRITE ${PROJECT_BINARY_DIR}/pch.cpp "")
  endif()
  set(all base base_portable wire wire_portable)
  if(MIRAGE_TESTS)
    list(APPEND all tests)
  endif()
  foreach(pch ${all})
    string(REPLACE "_portable" "" header ${pch})
    add_library(mirage_pch_${pch} OBJECT ${PROJECT_BINARY_DIR}/pch.cpp)
    set(kind)
    if(pch MATCHES portable)
      set(kind PORTABLE)
    elseif(pch STREQUAL tests)
      set(kind TEST)
    endif()
    mirage_target(mirage_pch_${pch} ${kind} PCH none)
    target_precompile_headers(mirage_pch_${pch} PRIVATE ${PROJECT_SOURCE_DIR}/cmake/pch/${header}.h)
    target_link_libraries(mirage_pch_${pch} PRIVATE glm::glm)
    if(NOT header STREQUAL base)
      target_include_directories(mirage_pch_${pch} SYSTEM PRIVATE ${PROJECT_BINARY_DIR}/generated)
      add_dependencies(mirage_pch_${pch} mirage_wire_header)
    endif()
  endforeach()
  if(TARGET GTest::gtest)
    target_link_libraries(mirage_pch_tests PRIVATE GTest::gtest)
  endif()
endfunction()
