// A library to be preloaded (LD_PRELOAD) into a program under test. It stands between the program
// and the driver's compiler.
//   SHADER_LOCALS=nan|zero   what no shader has written yet has this value (undefined_locals.h)
//   SHADER_DIR=PATH          every shader is also written there: HASH.vert or HASH.frag

#define GL_GLEXT_PROTOTYPES
#include <GL/gl.h>
#include <GL/glext.h>
#include <dlfcn.h>

#include <cstdlib>
#include <fstream>
#include <functional>
#include <string>

#include "tests/support/undefined_locals.h"

namespace {

std::string set_to(const char* name) {
  const char* value = std::getenv(name);
  return value ? value : "";
}

bool is_vertex(GLuint shader) {
  GLint type = 0;
  glGetShaderiv(shader, GL_SHADER_TYPE, &type);
  return type == GL_VERTEX_SHADER;
}

void keep(GLuint shader, const std::string& text) {
  static const std::string folder = set_to("SHADER_DIR");
  if (folder.empty()) return;
  const std::string name = std::to_string(std::hash<std::string>()(text));
  std::ofstream(folder + "/" + name + (is_vertex(shader) ? ".vert" : ".frag")) << text;
}

}  // namespace

extern "C" void glShaderSource(GLuint shader, GLsizei count, const GLchar* const* texts,
                               const GLint* lengths) {
  using mirage::test::Undefined;
  static const auto real =
      reinterpret_cast<decltype(&glShaderSource)>(dlsym(RTLD_NEXT, "glShaderSource"));
  static const std::string locals = set_to("SHADER_LOCALS");
  std::string all;
  for (GLsizei i = 0; i < count; ++i) {
    all += lengths && lengths[i] >= 0 ? std::string(texts[i], static_cast<std::size_t>(lengths[i]))
                                      : texts[i];
  }
  keep(shader, all);
  if (!locals.empty()) {
    all = mirage::test::with_defined_locals(all,
                                            locals == "nan" ? Undefined::kNan : Undefined::kZero);
  }
  const GLchar* text = all.c_str();
  real(shader, 1, &text, nullptr);
}
