#include "client/draw/refinement.h"

#include <algorithm>

#include "client/draw/frame_target.h"
#include "client/frame/planned_frame.h"
#include "client/hold/tile_cache.h"
#include "protocol/impostor/camera.h"
#include "shaders/gl/dialect.h"
#include "shaders/gl/gl_object.h"

namespace mirage {
namespace {

// Textures are read as sharply as by each of four by four samples of a pixel.
constexpr float kRefinedSharpenLevels = 2;

// Returns the n-th number of the Halton sequence in this base (J. H. Halton, 1960), 0 to 1.
double halton(int n, int base) {
  double out = 0, share = 1;
  for (; n > 0; n /= base) {
    share /= base;
    out += share * (n % base);
  }
  return out;
}

// Returns the offset of the n-th further drawing, pixels. Every second one is opposite to the one
// before, so that the mean of a few drawings stays where the picture was.
glm::dvec2 offset_px(int n) {
  const int pair = (n + 1) / 2;
  const glm::dvec2 offset = glm::dvec2(halton(pair, 2), halton(pair, 3)) - 0.5;
  return n % 2 != 0 ? offset : -offset;
}

}  // namespace

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

// Some devices truncate half floats, which makes a mean of 32 drawings darker.
GLenum Refinement::mean_format() { return gl::blends_floats() ? GL_RGBA32F : GL_RGBA16F; }

// Makes the targets and the program. Returns false if the device cannot; the picture then stays as
// it was drawn.
bool Refinement::make(const FrameTarget& target) {
  const bool same = one_sample_ && one_sample_->width() == target.width() &&
                    one_sample_->height() == target.height() &&
                    one_sample_->blends() == target.blends();
  if (same) return true;
  one_sample_.reset();
  if (!program_) {
    Result<gl::Program> program =
        gl::Program::create("common/fullscreen.vert", "common/copy.frag", {});
    if (!program) return false;
    program_ = program.take();
    vao_ = gl::VertexArray::create();
  }
  Result<FrameTarget> made =
      FrameTarget::create(target.width(), target.height(), 0, target.blends());
  if (!made) return false;
  const auto complete = [] {
    return glCheckFramebufferStatus(GL_FRAMEBUFFER) == GL_FRAMEBUFFER_COMPLETE;
  };
  drawing_ = make_plane(target.width(), target.height(), made->format());
  bool ok = complete();
  mean_ = make_plane(target.width(), target.height(), mean_format());
  ok = ok && complete() && made->format() == target.format();
  if (ok) one_sample_.emplace(made.take());
  return ok;
}

void Refinement::fill(const gl::Texture& from) {
  program_.use();
  program_.set("u_color", 0);
  glActiveTexture(GL_TEXTURE0);
  glBindTexture(GL_TEXTURE_2D, from.id());
  glViewport(0, 0, one_sample_->width(), one_sample_->height());
  glDisable(GL_DEPTH_TEST);
  glDisable(GL_CULL_FACE);
  glBindVertexArray(vao_.id());
  glDrawArrays(GL_TRIANGLES, 0, 3);
  glBindVertexArray(0);
  glEnable(GL_DEPTH_TEST);
}

void Refinement::add(const FrameTarget& drawn, float weight) {
  drawn.copy_to(drawing_.framebuffer);
  glBindFramebuffer(GL_FRAMEBUFFER, mean_.framebuffer.id());
  // The first drawing replaces what the new texture holds, because 0 times NaN is NaN.
  if (weight < 1) glEnable(GL_BLEND);
  glBlendColor(0, 0, 0, weight);
  glBlendFunc(GL_CONSTANT_ALPHA, GL_ONE_MINUS_CONSTANT_ALPHA);
  fill(drawing_.color);
  glDisable(GL_BLEND);
}

void Refinement::draw_more(FrameRenderer& renderer, const FrameTarget& target,
                           const PlannedFrame& frame) {
  if (done()) return;
  if (!make(target)) {
    drawings_ = kDrawings;
    return;
  }
  // An enlarged picture does not count as a first drawing.
  const int before = target.enlarges() ? 0 : std::max(target.samples(), 1);
  if (drawings_ == 0 && before > 0) add(target, 1);
  ++drawings_;
  PlannedFrame moved = frame;
  moved.camera.shift_px += offset_px(drawings_);
  renderer.sharpen(kRefinedSharpenLevels, kRefinedSharpenLevels);
  renderer.draw_edges_last(true);
  renderer.draw(*one_sample_, moved);
  renderer.draw_edges_last(false);
  renderer.sharpen_as_usual();
  add(*one_sample_, 1.0f / static_cast<float>(before + drawings_));
  one_sample_->bind();
  fill(mean_.color);
}

std::size_t Refinement::gpu_bytes() const {
  if (!one_sample_) return 0;
  const std::size_t pixels = static_cast<std::size_t>(one_sample_->width()) *
                             static_cast<std::size_t>(one_sample_->height());
  const std::size_t drawing = one_sample_->format() == GL_SRGB8_ALPHA8 ? 4 : 8;
  return one_sample_->gpu_bytes() + pixels * (16 + drawing);
}

}  // namespace mirage
