#include "server/render/readback_ring.h"

#include <algorithm>
#include <cstring>

#include "shaders/gl/health.h"

namespace mirage {
namespace {

gl::Buffer read_into_buffer(GLenum attachment, const PendingPage& info, GLenum format,
                            std::size_t bytes) {
  gl::Buffer buffer = gl::Buffer::create();
  glBindBuffer(GL_PIXEL_PACK_BUFFER, buffer.id());
  glBufferData(GL_PIXEL_PACK_BUFFER, static_cast<GLsizeiptr>(bytes), nullptr, GL_STREAM_READ);
  glReadBuffer(attachment);
  glPixelStorei(GL_PACK_ALIGNMENT, 1);
  glReadPixels(0, 0, info.width, info.height, format, GL_UNSIGNED_BYTE, nullptr);
  glBindBuffer(GL_PIXEL_PACK_BUFFER, 0);
  return buffer;
}

// Copies a buffer; false if it cannot be mapped.
bool copy_out(const gl::Buffer& buffer, std::vector<std::uint8_t>& out) {
  glBindBuffer(GL_PIXEL_PACK_BUFFER, buffer.id());
  const void* mapped = glMapBufferRange(GL_PIXEL_PACK_BUFFER, 0,
                                        static_cast<GLsizeiptr>(out.size()), GL_MAP_READ_BIT);
  bool good = mapped != nullptr;
  if (mapped) {
    std::memcpy(out.data(), mapped, out.size());
    good = glUnmapBuffer(GL_PIXEL_PACK_BUFFER) == GL_TRUE;
  }
  glBindBuffer(GL_PIXEL_PACK_BUFFER, 0);
  return good;
}

}  // namespace

ReadbackRing::~ReadbackRing() {
  for (Slot& slot : slots_) glDeleteSync(slot.fence);
}

void ReadbackRing::start(const gl::RenderTarget& page, PendingPage info) {
  glBindFramebuffer(GL_READ_FRAMEBUFFER, page.framebuffer());
  Slot slot;
  const std::size_t texels = static_cast<std::size_t>(info.width) * info.height;
  slot.color = read_into_buffer(GL_COLOR_ATTACHMENT0, info, GL_RGBA, texels * 4);
  slot.depth = read_into_buffer(GL_COLOR_ATTACHMENT1, info, GL_RED, texels);
  if (info.surface) {
    slot.surface = read_into_buffer(GL_COLOR_ATTACHMENT2, info, GL_RGBA, texels * 4);
  }
  slot.info = std::move(info);
  slot.fence = glFenceSync(GL_SYNC_GPU_COMMANDS_COMPLETE, 0);
  glFlush();
  slots_.push_back(std::move(slot));
}

Result<std::shared_ptr<const PagePixels>> ReadbackRing::read(const Slot& slot) {
  auto pixels = std::make_shared<PagePixels>();
  pixels->width = slot.info.width;
  pixels->height = slot.info.height;
  const std::size_t texels = static_cast<std::size_t>(pixels->width) * pixels->height;
  pixels->rgba.resize(texels * 4);
  pixels->depth.resize(texels);
  pixels->surface.resize(slot.info.surface ? texels * 4 : 0);
  const bool mapped = copy_out(slot.color, pixels->rgba) && copy_out(slot.depth, pixels->depth) &&
                      (!slot.info.surface || copy_out(slot.surface, pixels->surface));
  if (Result<void> healthy = gl::check_health("reading a page back"); !healthy) {
    return healthy.error();
  }
  if (!mapped)
    return make_error(ErrorId::kGraphicsGl, "a page that was read back cannot be mapped");
  return std::shared_ptr<const PagePixels>(std::move(pixels));
}

std::optional<ReadbackRing::Collected> ReadbackRing::collect(bool wait) {
  if (slots_.empty()) return std::nullopt;
  Slot& slot = slots_.front();
  constexpr GLuint64 kOneSecondNs = 1'000'000'000;
  GLenum state = GL_TIMEOUT_EXPIRED;
  while (state == GL_TIMEOUT_EXPIRED) {
    state = glClientWaitSync(slot.fence, GL_SYNC_FLUSH_COMMANDS_BIT, wait ? kOneSecondNs : 0);
    if (state == GL_TIMEOUT_EXPIRED && !wait) return std::nullopt;
  }
  glDeleteSync(slot.fence);
  const bool passed = state == GL_ALREADY_SIGNALED || state == GL_CONDITION_SATISFIED;
  Result<std::shared_ptr<const PagePixels>> pixels =
      passed ? read(slot) : make_error(ErrorId::kGraphicsGl, "the fence behind a page failed");
  Collected out{std::move(slot.info), std::move(pixels)};
  slots_.pop_front();
  return out;
}

}  // namespace mirage
