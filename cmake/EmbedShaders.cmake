# Run as a script: writes OUTPUT, a C++ file with the text of every file of FILES (relative to ROOT).
set(text "// Generated: the shader files, by name.\n#include \"shaders/gl/program.h\"\n\n")
string(APPEND text "namespace mirage::gl {\nstd::string_view shader_source(std::string_view name) {\n")
foreach(file ${FILES})
  file(READ ${ROOT}/${file} body)
  string(APPEND text "  if (name == \"${file}\") {\n    return R\"glsl(${body})glsl\";\n  }\n")
endforeach()
string(APPEND text "  return {};\n}\n}  // namespace mirage::gl\n")
file(WRITE ${OUTPUT} "${text}")
