#include "client/view/overlay.h"

#include <vector>

#pragma GCC diagnostic push
#pragma GCC diagnostic ignored "-Wall"
#pragma GCC diagnostic ignored "-Wextra"
#pragma GCC diagnostic ignored "-Wconversion"
#pragma GCC diagnostic ignored "-Wunused-function"
#include <stb/stb_easy_font.h>
#pragma GCC diagnostic pop

namespace mirage {
namespace {

constexpr float kScale = 2.0f;
constexpr float kMargin = 8.0f;

struct FontVertex {  // layout that stb_easy_font writes
  float x, y, z;
  unsigned char color[4];
};

// Returns the quads of the text as triangles, in pixels.
std::vector<glm::vec2> text_triangles(std::string text) {
  std::vector<FontVertex> quads(text.size() * 68);
  const int count = stb_easy_font_print(0, 0, text.data(), nullptr, quads.data(),
                                        static_cast<int>(quads.size() * sizeof(FontVertex)));
  std::vector<glm::vec2> out;
  for (std::size_t i = 0; i < static_cast<std::size_t>(count); ++i) {
    for (const std::size_t k : {0, 1, 2, 0, 2, 3}) {
      const FontVertex& v = quads[i * 4 + k];
      out.emplace_back(kMargin + v.x * kScale, kMargin + v.y * kScale);
    }
  }
  return out;
}

}  // namespace

Result<Overlay> Overlay::create() {
  Overlay out;
  Result<gl::Program> program =
      gl::Program::create("overlay/overlay.vert", "overlay/overlay.frag", {});
  if (!program) return program.error();
  out.program_ = program.take();
  out.vao_ = gl::VertexArray::create();
  out.vertices_ = gl::Buffer::create();
  return out;
}

void Overlay::draw(const std::string& text, int width, int height) {
  const std::vector<glm::vec2> triangles = text_triangles(text);
  if (triangles.empty()) return;
  glBindVertexArray(vao_.id());
  glBindBuffer(GL_ARRAY_BUFFER, vertices_.id());
  glBufferData(GL_ARRAY_BUFFER, static_cast<GLsizeiptr>(triangles.size() * sizeof(glm::vec2)),
               triangles.data(), GL_STREAM_DRAW);
  glEnableVertexAttribArray(0);
  glVertexAttribPointer(0, 2, GL_FLOAT, GL_FALSE, sizeof(glm::vec2), nullptr);
  glDisable(GL_DEPTH_TEST);
  glDisable(GL_BLEND);
  program_.use();
  const auto size = glm::vec2(width, height);
  // A dark copy underneath keeps the text readable on any picture.
  program_.set("u_size", size);
  program_.set("u_color", glm::vec4(0, 0, 0, 1));
  glViewport(1, -1, width, height);
  glDrawArrays(GL_TRIANGLES, 0, static_cast<GLsizei>(triangles.size()));
  program_.set("u_color", glm::vec4(1, 1, 0.6f, 1));
  glViewport(0, 0, width, height);
  glDrawArrays(GL_TRIANGLES, 0, static_cast<GLsizei>(triangles.size()));
  glBindVertexArray(0);
  glEnable(GL_DEPTH_TEST);
}

}  // namespace mirage
