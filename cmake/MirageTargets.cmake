# Helpers that give every target the same warnings, standard and sanitizers; no global flags.

# mirage_target(NAME [PORTABLE]): PORTABLE keeps to C++17, for the code that also builds for a browser.
function(mirage_target name)
  cmake_parse_arguments(ARG "PORTABLE" "" "" ${ARGN})
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
                         $<$<CXX_COMPILER_ID:GNU>:-Wno-restrict>  # false alarms of GCC 12 on std::string
                         -fno-math-errno)
  if(MIRAGE_SANITIZE)
    # GCC 12 sees uninitialised members in std::variant once sanitizers instrument it.
    target_compile_options(${name} PRIVATE $<$<CXX_COMPILER_ID:GNU>:-Wno-maybe-uninitialized>)
    target_compile_options(${name} PUBLIC -fsanitize=${MIRAGE_SANITIZE} -fno-omit-frame-pointer)
    target_link_options(${name} PUBLIC -fsanitize=${MIRAGE_SANITIZE})
    if(MIRAGE_SANITIZE MATCHES "undefined")
      target_compile_options(${name} PUBLIC -fno-sanitize-recover=undefined)
    endif()
  endif()
endfunction()
