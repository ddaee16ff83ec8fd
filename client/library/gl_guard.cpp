#include "client/library/gl_guard.h"

#include <algorithm>

#include "shaders/gl/dialect.h"

namespace mirage {
namespace {

constexpr GLuint kWhiteAttribute = 5;  // MeshPass sets it for meshes without colours

// Off at first, and while Mirage draws unless it turns them on.
constexpr GLenum kOff[] = {GL_DEPTH_TEST,
                           GL_BLEND,
                           GL_CULL_FACE,
                           GL_SCISSOR_TEST,
                           GL_STENCIL_TEST,
                           GL_POLYGON_OFFSET_FILL,
                           GL_SAMPLE_ALPHA_TO_COVERAGE,
                           GL_SAMPLE_COVERAGE,
                           GL_RASTERIZER_DISCARD};
// Off in the same way, in OpenGL only.
constexpr GLenum kOffInOpenGl[] = {
    GL_FRAMEBUFFER_SRGB,    GL_PROGRAM_POINT_SIZE,   GL_COLOR_LOGIC_OP,
    GL_PRIMITIVE_RESTART,   GL_DEPTH_CLAMP,          GL_SAMPLE_MASK,
    GL_SAMPLE_ALPHA_TO_ONE, GL_POLYGON_SMOOTH,       GL_LINE_SMOOTH,
    GL_POLYGON_OFFSET_LINE, GL_POLYGON_OFFSET_POINT, GL_TEXTURE_CUBE_MAP_SEAMLESS,
    GL_CLIP_DISTANCE0,      GL_CLIP_DISTANCE1,       GL_CLIP_DISTANCE2,
    GL_CLIP_DISTANCE3,      GL_CLIP_DISTANCE4,       GL_CLIP_DISTANCE5,
    GL_CLIP_DISTANCE6,      GL_CLIP_DISTANCE7};

struct PixelStore {
  GLenum name;
  GLint initial;
  bool embedded;  // OpenGL ES has it, too
};
constexpr PixelStore kPixelStore[] = {
    {GL_UNPACK_ALIGNMENT, 4, true},    {GL_UNPACK_ROW_LENGTH, 0, true},
    {GL_UNPACK_SKIP_ROWS, 0, true},    {GL_UNPACK_SKIP_PIXELS, 0, true},
    {GL_UNPACK_IMAGE_HEIGHT, 0, true}, {GL_UNPACK_SKIP_IMAGES, 0, true},
    {GL_UNPACK_SWAP_BYTES, 0, false},  {GL_UNPACK_LSB_FIRST, 0, false},
    {GL_PACK_ALIGNMENT, 4, true},      {GL_PACK_ROW_LENGTH, 0, true},
    {GL_PACK_SKIP_ROWS, 0, true},      {GL_PACK_SKIP_PIXELS, 0, true},
    {GL_PACK_IMAGE_HEIGHT, 0, false},  {GL_PACK_SKIP_IMAGES, 0, false},
    {GL_PACK_SWAP_BYTES, 0, false},    {GL_PACK_LSB_FIRST, 0, false}};

GLint integer(GLenum name) {
  GLint value = 0;
  glGetIntegerv(name, &value);
  return value;
}

GLfloat number(GLenum name) {
  GLfloat value = 0;
  glGetFloatv(name, &value);
  return value;
}

void turn(GLenum name, bool on) { (on ? glEnable : glDisable)(name); }

void bind(GLenum kind, GLint name) { glBindTexture(kind, static_cast<GLuint>(name)); }

}  // namespace

GlGuard::GlGuard()
    : embedded_(gl::is_embedded()),
      clip_control_(!embedded_ && gl::has_clip_control()),
      version_(integer(GL_MAJOR_VERSION) * 10 + integer(GL_MINOR_VERSION)) {
  save_switches();
  save_values();
  save_bindings();
  for (const Switch& one : switches_) turn(one.name, false);
  turn(GL_DITHER, true);
  if (!embedded_) {
    turn(GL_MULTISAMPLE, true);
    glPolygonMode(GL_FRONT_AND_BACK, GL_FILL);
    glProvokingVertex(GL_LAST_VERTEX_CONVENTION);
  }
  if (clip_control_) glClipControl(GL_LOWER_LEFT, GL_NEGATIVE_ONE_TO_ONE);
  for (const PixelStore& one : kPixelStore) {
    if (one.embedded || !embedded_) glPixelStorei(one.name, one.initial);
  }
  for (std::size_t i = 0; i < units_.size(); ++i) glBindSampler(static_cast<GLuint>(i), 0);
  set_initial();
  gl::prepare_points_and_samples();
  gl::encode_srgb(true);
}

void GlGuard::save_switches() {
  const auto save = [this](GLenum name) {
    switches_.push_back({name, glIsEnabled(name) == GL_TRUE});
  };
  for (const GLenum name : kOff) save(name);
  save(GL_DITHER);
  if (embedded_ || version_ >= 43) save(GL_PRIMITIVE_RESTART_FIXED_INDEX);
  if (embedded_) return;
  for (const GLenum name : kOffInOpenGl) save(name);
  save(GL_MULTISAMPLE);
  if (version_ >= 40) save(GL_SAMPLE_SHADING);
  draw_buffers_ = std::min(integer(GL_MAX_DRAW_BUFFERS), 8);
  for (int i = 0; i < draw_buffers_; ++i) {
    const auto at = static_cast<std::size_t>(i);
    blends_[at] = glIsEnabledi(GL_BLEND, static_cast<GLuint>(i)) == GL_TRUE;
    glGetBooleani_v(GL_COLOR_WRITEMASK, static_cast<GLuint>(i), color_masks_[at].data());
  }
}

void GlGuard::save_values() {
  if (embedded_) {
    glGetBooleanv(GL_COLOR_WRITEMASK, color_masks_[0].data());
  } else {
    std::array<GLint, 2> modes{};
    glGetIntegerv(GL_POLYGON_MODE, modes.data());
    polygon_mode_ = modes;
    provoking_ = integer(GL_PROVOKING_VERTEX);
    if (version_ >= 40) sample_share_ = number(GL_MIN_SAMPLE_SHADING_VALUE);
  }
  if (clip_control_) {
    clip_origin_ = integer(GL_CLIP_ORIGIN);
    clip_depth_ = integer(GL_CLIP_DEPTH_MODE);
  }
  for (std::size_t i = 0; i < pixel_store_.size(); ++i) {
    if (kPixelStore[i].embedded || !embedded_) pixel_store_[i] = integer(kPixelStore[i].name);
  }
  glGetFloatv(GL_COLOR_CLEAR_VALUE, clear_color_.data());
  glGetFloatv(GL_BLEND_COLOR, blend_color_.data());
  glGetFloatv(GL_DEPTH_RANGE, depth_range_.data());
  glGetVertexAttribfv(kWhiteAttribute, GL_CURRENT_VERTEX_ATTRIB, attribute_.data());
  glGetIntegerv(GL_VIEWPORT, viewport_.data());
  glGetIntegerv(GL_SCISSOR_BOX, scissor_.data());
  glGetBooleanv(GL_DEPTH_WRITEMASK, &depth_mask_);
  clear_depth_ = number(GL_DEPTH_CLEAR_VALUE);
  line_width_ = number(GL_LINE_WIDTH);
  depth_func_ = integer(GL_DEPTH_FUNC);
  cull_ = integer(GL_CULL_FACE_MODE);
  front_ = integer(GL_FRONT_FACE);
  blending_.source_rgb = integer(GL_BLEND_SRC_RGB);
  blending_.source_alpha = integer(GL_BLEND_SRC_ALPHA);
  blending_.target_rgb = integer(GL_BLEND_DST_RGB);
  blending_.target_alpha = integer(GL_BLEND_DST_ALPHA);
  blending_.equation_rgb = integer(GL_BLEND_EQUATION_RGB);
  blending_.equation_alpha = integer(GL_BLEND_EQUATION_ALPHA);
}

void GlGuard::save_bindings() {
  bindings_.program = integer(GL_CURRENT_PROGRAM);
  bindings_.vertex_array = integer(GL_VERTEX_ARRAY_BINDING);
  bindings_.array_buffer = integer(GL_ARRAY_BUFFER_BINDING);
  bindings_.pack_buffer = integer(GL_PIXEL_PACK_BUFFER_BINDING);
  bindings_.unpack_buffer = integer(GL_PIXEL_UNPACK_BUFFER_BINDING);
  bindings_.read_framebuffer = integer(GL_READ_FRAMEBUFFER_BINDING);
  bindings_.draw_framebuffer = integer(GL_DRAW_FRAMEBUFFER_BINDING);
  bindings_.renderbuffer = integer(GL_RENDERBUFFER_BINDING);
  bindings_.active_unit = integer(GL_ACTIVE_TEXTURE);
  for (std::size_t i = 0; i < units_.size(); ++i) {
    glActiveTexture(GL_TEXTURE0 + static_cast<GLenum>(i));
    units_[i] = {integer(GL_TEXTURE_BINDING_2D), integer(GL_TEXTURE_BINDING_2D_ARRAY),
                 integer(GL_TEXTURE_BINDING_CUBE_MAP), integer(GL_TEXTURE_BINDING_3D),
                 integer(GL_SAMPLER_BINDING)};
  }
}

void GlGuard::set_initial() {
  glColorMask(GL_TRUE, GL_TRUE, GL_TRUE, GL_TRUE);
  glClearColor(0, 0, 0, 0);
  glClearDepthf(1);
  glDepthRangef(0, 1);
  glDepthFunc(GL_LESS);
  glDepthMask(GL_TRUE);
  glCullFace(GL_BACK);
  glFrontFace(GL_CCW);
  glLineWidth(1);
  glBlendFunc(GL_ONE, GL_ZERO);
  glBlendEquation(GL_FUNC_ADD);
  glBindBuffer(GL_PIXEL_PACK_BUFFER, 0);
  glBindBuffer(GL_PIXEL_UNPACK_BUFFER, 0);
  glBindVertexArray(0);
}

void GlGuard::restore_values() const {
  for (const Switch& one : switches_) turn(one.name, one.on);
  if (embedded_) {
    const auto& mask = color_masks_[0];
    glColorMask(mask[0], mask[1], mask[2], mask[3]);
  } else {
    for (int i = 0; i < draw_buffers_; ++i) {
      const auto at = static_cast<std::size_t>(i);
      const auto& mask = color_masks_[at];
      (blends_[at] ? glEnablei : glDisablei)(GL_BLEND, static_cast<GLuint>(i));
      glColorMaski(static_cast<GLuint>(i), mask[0], mask[1], mask[2], mask[3]);
    }
    glPolygonMode(GL_FRONT_AND_BACK, static_cast<GLenum>(polygon_mode_[0]));
    glProvokingVertex(static_cast<GLenum>(provoking_));
    if (version_ >= 40) glMinSampleShading(sample_share_);
  }
  if (clip_control_) {
    glClipControl(static_cast<GLenum>(clip_origin_), static_cast<GLenum>(clip_depth_));
  }
  for (std::size_t i = 0; i < pixel_store_.size(); ++i) {
    const PixelStore& one = kPixelStore[i];
    if (one.embedded || !embedded_) glPixelStorei(one.name, pixel_store_[i]);
  }
  glClearColor(clear_color_[0], clear_color_[1], clear_color_[2], clear_color_[3]);
  glBlendColor(blend_color_[0], blend_color_[1], blend_color_[2], blend_color_[3]);
  glDepthRangef(depth_range_[0], depth_range_[1]);
  glVertexAttrib4fv(kWhiteAttribute, attribute_.data());
  glViewport(viewport_[0], viewport_[1], viewport_[2], viewport_[3]);
  glScissor(scissor_[0], scissor_[1], scissor_[2], scissor_[3]);
  glDepthMask(depth_mask_);
  glClearDepthf(clear_depth_);
  glLineWidth(line_width_);
  glDepthFunc(static_cast<GLenum>(depth_func_));
  glCullFace(static_cast<GLenum>(cull_));
  glFrontFace(static_cast<GLenum>(front_));
  glBlendFuncSeparate(
      static_cast<GLenum>(blending_.source_rgb), static_cast<GLenum>(blending_.target_rgb),
      static_cast<GLenum>(blending_.source_alpha), static_cast<GLenum>(blending_.target_alpha));
  glBlendEquationSeparate(static_cast<GLenum>(blending_.equation_rgb),
                          static_cast<GLenum>(blending_.equation_alpha));
}

void GlGuard::restore_bindings() const {
  for (std::size_t i = 0; i < units_.size(); ++i) {
    glActiveTexture(GL_TEXTURE0 + static_cast<GLenum>(i));
    bind(GL_TEXTURE_2D, units_[i].texture_2d);
    bind(GL_TEXTURE_2D_ARRAY, units_[i].array);
    bind(GL_TEXTURE_CUBE_MAP, units_[i].cube);
    bind(GL_TEXTURE_3D, units_[i].volume);
    glBindSampler(static_cast<GLuint>(i), static_cast<GLuint>(units_[i].sampler));
  }
  glActiveTexture(static_cast<GLenum>(bindings_.active_unit));
  glUseProgram(static_cast<GLuint>(bindings_.program));
  glBindVertexArray(static_cast<GLuint>(bindings_.vertex_array));
  glBindBuffer(GL_ARRAY_BUFFER, static_cast<GLuint>(bindings_.array_buffer));
  glBindBuffer(GL_PIXEL_PACK_BUFFER, static_cast<GLuint>(bindings_.pack_buffer));
  glBindBuffer(GL_PIXEL_UNPACK_BUFFER, static_cast<GLuint>(bindings_.unpack_buffer));
  glBindFramebuffer(GL_READ_FRAMEBUFFER, static_cast<GLuint>(bindings_.read_framebuffer));
  glBindFramebuffer(GL_DRAW_FRAMEBUFFER, static_cast<GLuint>(bindings_.draw_framebuffer));
  glBindRenderbuffer(GL_RENDERBUFFER, static_cast<GLuint>(bindings_.renderbuffer));
}

GlGuard::~GlGuard() {
  restore_values();
  restore_bindings();
}

}  // namespace mirage
