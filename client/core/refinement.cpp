#include "client/core/refinement.h"

namespace mirage {
namespace {

// As sharp as each of four by four samples of a pixel would read its textures.
constexpr float kSharpenLevels = 2;

// The n-th number of the sequence in this base (J. H. Halton, 1960), 0 to 1.
double halton(int n, int base) {
  double out = 0, share = 1;
  for (; n > 0; n /= base) {
    share /= base;
    out += share * (n % base);
  }
  return out;
}

}  // namespace

Result<Refinement> Refinement::create() {
  Refinement out;
  Result<gl::Program> program =
      gl::Program::create("common/fullscreen.vert", "common/copy.frag", {});
  if (!program) return program.error();
  out.program_ = program.take();
  out.vao_ = gl::VertexArray::create();
  return out;
}

Refinement::Plane Refinement::make_plane(int width, int height, GLenum format) {
  Plane out{gl::Framebuffer::create(), gl::Texture::create()};
  glBindTexture(GL_TEXTURE_2D, out.color.id());
  glTexStorage2D(GL_TEXTURE_2D, 1, format, width, height);
  glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MIN_FILTER, GL_NEAREST);
  glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MAG_FILTER, GL_NEAREST);
  glBindFramebuffer(GL_FRAMEBUFFER, out.framebuffer.id());
  glFramebufferTexture2D(GL_FRAMEBUFFER, GL_COLOR_ATTACHMENT0, GL_TEXTURE_2D, out.color.id(), 0);
  return out;
}

// False where the device cannot: the picture stays as it was drawn.
bool Refinement::make(const FrameTarget& target) {
  const bool same = width_ == target.width() && height_ == target.height() &&
                    format_ == target.format() && mean_.color;
  if (same) return true;
  width_ = target.width();
  height_ = target.height();
  format_ = target.format();
  const auto complete = [] {
    return glCheckFramebufferStatus(GL_FRAMEBUFFER) == GL_FRAMEBUFFER_COMPLETE;
  };
  drawing_ = make_plane(width_, height_, format_);
  bool ok = complete();
  mean_ = make_plane(width_, height_, GL_RGBA16F);
  ok = ok && complete();
  if (!ok) {
    drawing_ = Plane();
    mean_ = Plane();
  }
  return ok;
}

void Refinement::fill(const gl::Texture& from) {
  program_.use();
  program_.set("u_color", 0);
  glActiveTexture(GL_TEXTURE0);
  glBindTexture(GL_TEXTURE_2D, from.id());
  glDisable(GL_DEPTH_TEST);
  glDisable(GL_CULL_FACE);
  glBindVertexArray(vao_.id());
  glDrawArrays(GL_TRIANGLES, 0, 3);
  glBindVertexArray(0);
  glEnable(GL_DEPTH_TEST);
}

void Refinement::add(const FrameTarget& target, float weight) {
  target.copy_to(drawing_.framebuffer);
  glBindFramebuffer(GL_FRAMEBUFFER, mean_.framebuffer.id());
  glEnable(GL_BLEND);
  glBlendColor(0, 0, 0, weight);
  glBlendFunc(GL_CONSTANT_ALPHA, GL_ONE_MINUS_CONSTANT_ALPHA);
  fill(drawing_.color);
  glDisable(GL_BLEND);
}

void Refinement::draw_more(FrameRenderer& renderer, const FrameTarget& target, const Camera& camera,
                           const SceneView& scene, const DrawList& list, const Lighting& lighting) {
  if (done()) return;
  if (!make(target)) {
    drawings_ = kDrawings;
    return;
  }
  if (drawings_ == 1) add(target, 1);
  Camera moved = camera;
  moved.shift_px = glm::dvec2(halton(drawings_, 2), halton(drawings_, 3)) - 0.5;
  renderer.sharpen(kSharpenLevels, kSharpenLevels);
  renderer.draw(target, moved, scene, list, lighting);
  renderer.sharpen_as_usual();
  ++drawings_;
  add(target, 1.0f / static_cast<float>(drawings_));
  target.bind();
  fill(mean_.color);
}

std::size_t Refinement::gpu_bytes() const {
  if (!mean_.color) return 0;
  const std::size_t drawing = format_ == GL_SRGB8_ALPHA8 ? 4 : 8;
  return static_cast<std::size_t>(width_) * static_cast<std::size_t>(height_) * (8 + drawing);
}

}  // namespace mirage
