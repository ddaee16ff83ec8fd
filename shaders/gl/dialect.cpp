#include "shaders/gl/dialect.h"

#include <cstring>

#ifdef __EMSCRIPTEN__
#include <emscripten.h>
#endif

namespace mirage::gl {
namespace {

#ifdef __EMSCRIPTEN__
constexpr GLenum kRendererName = 0x9246;  // UNMASKED_RENDERER_WEBGL
// clang-format off
EM_JS(int, find_clip_control, (), {
  const extension = GLctx.getExtension('EXT_clip_control');
  return extension ? 1 : 0;
});
EM_JS(void, web_clip_control, (int zero_to_one), {
  const e = GLctx.getExtension('EXT_clip_control');
  if (e) e.clipControlEXT(e.LOWER_LEFT_EXT, zero_to_one ? e.ZERO_TO_ONE_EXT : e.NEGATIVE_ONE_TO_ONE_EXT);
});
EM_JS(int, find_float_blend, (), {
  return GLctx.getExtension('EXT_color_buffer_float') && GLctx.getExtension('EXT_float_blend') ? 1 : 0;
});
EM_JS(int, find_renderer_name, (), {
  return GLctx.getExtension('WEBGL_debug_renderer_info') ? 1 : 0;
});
// clang-format on
#endif

std::string text_of(GLenum name) {
  const auto* text = reinterpret_cast<const char*>(glGetString(name));
  return text ? text : "";
}

[[maybe_unused]] bool has_extension(const char* wanted) {
  GLint count = 0;
  glGetIntegerv(GL_NUM_EXTENSIONS, &count);
  for (GLint i = 0; i < count; ++i) {
    const auto* name = glGetStringi(GL_EXTENSIONS, static_cast<GLuint>(i));
    if (std::strcmp(reinterpret_cast<const char*>(name), wanted) == 0) return true;
  }
  return false;
}

}  // namespace

#ifdef __EMSCRIPTEN__

bool is_embedded() { return true; }
void encode_srgb(bool) {}
void shade_samples(bool) {}
void prepare_points_and_samples() {}
bool has_clip_control() { return find_clip_control() != 0; }
void set_clip_depth_zero_to_one(bool on) { web_clip_control(on ? 1 : 0); }
bool blends_floats() { return find_float_blend() != 0; }
std::string renderer_name() {
  return text_of(find_renderer_name() != 0 ? kRendererName : GL_RENDERER);
}

#else

bool is_embedded() { return text_of(GL_VERSION).rfind("OpenGL ES", 0) == 0; }

void encode_srgb(bool on) {
  if (!is_embedded()) (on ? glEnable : glDisable)(GL_FRAMEBUFFER_SRGB);
}

void shade_samples(bool on) {
  if (!is_embedded()) (on ? glEnable : glDisable)(GL_SAMPLE_SHADING);
}

void prepare_points_and_samples() {
  if (is_embedded()) return;
  glMinSampleShading(1.0f);
  glEnable(GL_PROGRAM_POINT_SIZE);
}

bool has_clip_control() {
  GLint major = 0, minor = 0;
  glGetIntegerv(GL_MAJOR_VERSION, &major);
  glGetIntegerv(GL_MINOR_VERSION, &minor);
  if (is_embedded()) return has_extension("GL_EXT_clip_control");
  return major * 10 + minor >= 45 || has_extension("GL_ARB_clip_control");
}

void set_clip_depth_zero_to_one(bool on) {
  glClipControl(GL_LOWER_LEFT, on ? GL_ZERO_TO_ONE : GL_NEGATIVE_ONE_TO_ONE);
}

bool blends_floats() { return !is_embedded() || has_extension("GL_EXT_float_blend"); }

std::string renderer_name() { return text_of(GL_RENDERER); }

#endif

// `precise` keeps the compiler from contracting multiply and add differently in two variants of a
// shader, which must draw the same to the bit. It needs OpenGL 4.0 or ARB_gpu_shader5. OpenGL
// ES 3.0 has only `invariant`; mesh.vert declares it for positions.
std::string shader_header() {
  const std::string precise = "#define PRECISE_BUILT_IN(name) precise name;\n";
  const std::string imprecise = "#define precise\n#define PRECISE_BUILT_IN(name)\n";
  GLint major = 0;
  glGetIntegerv(GL_MAJOR_VERSION, &major);
  if (!is_embedded() && major >= 4) return "#version 400 core\n" + precise;
  if (!is_embedded() && has_extension("GL_ARB_gpu_shader5")) {
    return "#version 330 core\n#extension GL_ARB_gpu_shader5 : require\n" + precise;
  }
  if (!is_embedded()) return "#version 330 core\n" + imprecise;
  return "#version 300 es\n" + imprecise +
         "precision highp float;\nprecision highp int;\nprecision highp sampler2D;\n"
         "precision highp sampler2DArray;\nprecision highp sampler2DShadow;\n"
         "precision highp samplerCube;\n";
}

}  // namespace mirage::gl
