#pragma once
// GL guard: keeps a host's GL state from Mirage, and Mirage's from the host. While one exists, the
// context is in GL's initial state as far as drawing here depends on it; then all is as before.
// It covers what client/draw and shaders/gl set, and what a host may have set that would change
// their pictures. Per context, so not objects, and neither queries nor transform feedback.
// Thread: the GL thread.

#include <array>
#include <vector>

#include "shaders/gl/gl.h"

namespace mirage {

class GlGuard {
 public:
  GlGuard();
  ~GlGuard();
  GlGuard(const GlGuard&) = delete;
  GlGuard& operator=(const GlGuard&) = delete;

 private:
  struct Switch {
    GLenum name;
    bool on;
  };
  struct Unit {
    GLint texture_2d = 0, array = 0, cube = 0, volume = 0, sampler = 0;
  };
  struct Blending {
    GLint source_rgb = 0, source_alpha = 0, target_rgb = 0, target_alpha = 0;
    GLint equation_rgb = 0, equation_alpha = 0;
  };
  struct Bindings {
    GLint program = 0, vertex_array = 0, array_buffer = 0, pack_buffer = 0, unpack_buffer = 0;
    GLint read_framebuffer = 0, draw_framebuffer = 0, renderbuffer = 0, active_unit = 0;
  };
  void save_switches();
  void save_values();
  void save_bindings();
  static void set_initial();
  void restore_values() const;
  void restore_bindings() const;

  bool embedded_ = false, clip_control_ = false;
  int version_ = 0;  ///< major * 10 + minor
  std::vector<Switch> switches_;
  std::array<bool, 8> blends_{};
  std::array<std::array<GLboolean, 4>, 8> color_masks_{};
  int draw_buffers_ = 1;
  std::array<GLint, 16> pixel_store_{};
  std::array<Unit, 16> units_{};
  std::array<GLfloat, 4> clear_color_{}, blend_color_{}, attribute_{};
  std::array<GLfloat, 2> depth_range_{};
  std::array<GLint, 4> viewport_{}, scissor_{};
  std::array<GLint, 2> polygon_mode_{};
  GLboolean depth_mask_ = GL_TRUE;
  GLfloat clear_depth_ = 1, line_width_ = 1, sample_share_ = 0;
  GLint depth_func_ = 0, cull_ = 0, front_ = 0, provoking_ = 0, clip_origin_ = 0, clip_depth_ = 0;
  Blending blending_;
  Bindings bindings_;
};

}  // namespace mirage
