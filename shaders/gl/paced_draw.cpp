#include "shaders/gl/paced_draw.h"

#include <algorithm>
#include <array>

#include "shaders/gl/renderer.h"

namespace mirage::gl {
namespace {

constexpr std::size_t kPart = 131'072;  // points, lines or triangles
constexpr GLuint64 kOneSecond = 1'000'000'000;

std::size_t corners_of(GLenum mode) {
  if (mode == GL_TRIANGLES) return 3;
  return mode == GL_LINES ? 2 : 1;
}

void draw_part(GLenum mode, std::size_t first_index, std::size_t count, std::size_t instances) {
  glDrawElementsInstanced(mode, static_cast<GLsizei>(count), GL_UNSIGNED_INT,
                          reinterpret_cast<const void*>(first_index * sizeof(GLuint)),
                          static_cast<GLsizei>(instances));
}

bool can_wait() {
#ifdef __EMSCRIPTEN__
  return false;  // a browser's page may not wait for its renderer
#else
  return true;
#endif
}

/// The end of the work of a part.
class Fence {
 public:
  Fence() = default;
  Fence(const Fence&) = delete;
  Fence& operator=(const Fence&) = delete;
  ~Fence() { glDeleteSync(sync_); }  // ignores null

  /// Waits for the part before, then marks the end of another.
  void renew() {
    if (sync_) glClientWaitSync(sync_, GL_SYNC_FLUSH_COMMANDS_BIT, kOneSecond);
    glDeleteSync(sync_);
    sync_ = glFenceSync(GL_SYNC_GPU_COMMANDS_COMPLETE, 0);
    glFlush();
  }

 private:
  GLsync sync_ = nullptr;
};

}  // namespace

void draw_elements(GLenum mode, std::size_t first_index, std::size_t count, std::size_t instances) {
  const std::size_t part = kPart * corners_of(mode);
  if (count <= part || instances != 1 || !can_wait() || !is_software()) {
    draw_part(mode, first_index, count, instances);
    return;
  }
  std::array<Fence, 2> ends;
  for (std::size_t done = 0, k = 0; done < count; done += part, ++k) {
    if (done > 0) ends[k % ends.size()].renew();
    draw_part(mode, first_index + done, std::min(part, count - done), instances);
  }
}

}  // namespace mirage::gl
