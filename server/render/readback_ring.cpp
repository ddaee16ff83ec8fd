#include "server/render/readback_ring.h"

#include <algorithm>
#include <cstring>

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

void copy_out(const gl::Buffer& buffer, std::vector<std::uint8_t>& out) {
  glBindBuffer(GL_PIXEL_PACK_BUFFER, buffer.id());
  const void* mapped = glMapBufferRange(GL_PIXEL_PACK_BUFFER, 0,
                                        static_cast<GLsizeiptr>(out.size()), GL_MAP_READ_BIT);
  if (mapped) {
    std::memcpy(out.data(), mapped, out.size());
    glUnmapBuffer(GL_PIXEL_PACK_BUFFER);
  }
  glBindBuffer(GL_PIXEL_PACK_BUFFER, 0);
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

std::optional<ReadbackRing::Collected> ReadbackRing::collect(bool wait) {
  if (slots_.empty()) return std::nullopt;
  Slot& slot = slots_.front();
  constexpr GLuint64 kOneSecondNs = 1'000'000'000;
  for (;;) {
    const GLenum state =
        glClientWaitSync(slot.fence, GL_SYNC_FLUSH_COMMANDS_BIT, wait ? kOneSecondNs : 0);
    if (state != GL_TIMEOUT_EXPIRED) break;
    if (!wait) return std::nullopt;
  }
  glDeleteSync(slot.fence);
  auto pixels = std::make_shared<PagePixels>();
  pixels->width = slot.info.width;
  pixels->height = slot.info.height;
  const std::size_t texels = static_cast<std::size_t>(pixels->width) * pixels->height;
  pixels->rgba.resize(texels * 4);
  pixels->depth.resize(texels);
  copy_out(slot.color, pixels->rgba);
  copy_out(slot.depth, pixels->depth);
  if (slot.info.surface) {
    pixels->surface.resize(texels * 4);
    copy_out(slot.surface, pixels->surface);
  }
  Collected out{std::move(slot.info), std::move(pixels)};
  slots_.pop_front();
  return out;
}

}  // namespace mirage
