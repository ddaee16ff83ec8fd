#include "client/draw/view_pass.h"

#include <algorithm>
#include <cmath>
#include <cstddef>

#include "shaders/gl/view_depth.h"

namespace mirage {
namespace {

struct CellVertex {
  glm::vec3 position;
  glm::vec2 texture;
};

// Sky beside a surface gets the surface's depth, so that an outline keeps the colours mixed into
// it.
std::uint8_t code_at(const ViewTile& view, std::uint32_t x, std::uint32_t y) {
  const std::uint8_t own = view.depth[std::size_t{y} * view.columns() + x];
  if (own != 0) return own;
  std::uint8_t farthest = 0;
  for (std::uint32_t v = y > 0 ? y - 1 : 0; v <= std::min(y + 1, view.rows() - 1); ++v) {
    for (std::uint32_t u = x > 0 ? x - 1 : 0; u <= std::min(x + 1, view.columns() - 1); ++u) {
      const std::uint8_t code = view.depth[std::size_t{v} * view.columns() + u];
      if (code != 0 && (farthest == 0 || code < farthest)) farthest = code;
    }
  }
  return farthest;
}

std::vector<CellVertex> cell_vertices(const ViewTile& view) {
  const Camera& c = view.camera;
  const double up = std::tan(0.5 * c.fov_y), right = up * c.width / c.height;
  std::vector<CellVertex> out;
  out.reserve(view.depth.size());
  for (std::uint32_t y = 0; y < view.rows(); ++y) {
    for (std::uint32_t x = 0; x < view.columns(); ++x) {
      const glm::dvec2 at = (glm::dvec2(x, y) + 0.5) / glm::dvec2(view.columns(), view.rows());
      const glm::dvec3 ray =
          c.forward() + c.right() * (right * (2 * at.x - 1)) + c.up() * (up * (1 - 2 * at.y));
      const std::uint8_t code = code_at(view, x, y);
      const double depth = code == 0 ? view.far_m : view.decode_depth(code);
      out.push_back({glm::vec3(ray * depth), glm::vec2(at)});
    }
  }
  return out;
}

}  // namespace

Result<ViewPass> ViewPass::create() {
  ViewPass pass;
  Result<gl::Program> program = gl::Program::create("view/view.vert", "view/view.frag", {});
  if (!program) return program.error();
  pass.program_ = program.take();
  pass.vao_ = gl::VertexArray::create();
  pass.vertices_ = gl::Buffer::create();
  pass.indices_ = gl::Buffer::create();
  return pass;
}

void ViewPass::upload(const ViewTile& view) {
  const std::vector<CellVertex> vertices = cell_vertices(view);
  glBindVertexArray(vao_.id());
  glBindBuffer(GL_ARRAY_BUFFER, vertices_.id());
  glBufferData(GL_ARRAY_BUFFER, static_cast<GLsizeiptr>(vertices.size() * sizeof(CellVertex)),
               vertices.data(), GL_STATIC_DRAW);
  glEnableVertexAttribArray(0);
  glVertexAttribPointer(0, 3, GL_FLOAT, GL_FALSE, sizeof(CellVertex), nullptr);
  glEnableVertexAttribArray(1);
  glVertexAttribPointer(1, 2, GL_FLOAT, GL_FALSE, sizeof(CellVertex),
                        reinterpret_cast<const void*>(offsetof(CellVertex, texture)));
  glBindBuffer(GL_ELEMENT_ARRAY_BUFFER, indices_.id());
  glBindVertexArray(0);
  color_ = gl::Texture::create();
  glBindTexture(GL_TEXTURE_2D, color_.id());
  glPixelStorei(GL_UNPACK_ALIGNMENT, 1);
  glTexImage2D(GL_TEXTURE_2D, 0, GL_SRGB8_ALPHA8, static_cast<GLsizei>(view.camera.width),
               static_cast<GLsizei>(view.camera.height), 0, GL_RGBA, GL_UNSIGNED_BYTE,
               view.rgba.data());
  glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MIN_FILTER, GL_LINEAR);
  glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_WRAP_S, GL_CLAMP_TO_EDGE);
  glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_WRAP_T, GL_CLAMP_TO_EDGE);
  columns_ = view.columns();
  rows_ = view.rows();
  depth_ = view.depth;
  owners_ = view.owners;
  eye_ = view.camera.pose.eye;
  shown_.clear();
  index_count_ = 0;
  gpu_bytes_ =
      vertices.size() * (sizeof(CellVertex) + 6 * sizeof(std::uint32_t)) + view.rgba.size();
}

void ViewPass::show(const std::vector<bool>& owners) {
  const auto shown = [&](std::size_t cell) {
    const std::uint16_t owner = owners_[cell];
    return depth_[cell] != 0 && (owner == ViewTile::kNobody || owners[owner - 1u]);
  };
  std::vector<std::uint32_t> indices;
  for (std::uint32_t y = 0; y + 1 < rows_; ++y) {
    for (std::uint32_t x = 0; x + 1 < columns_; ++x) {
      const std::uint32_t a = y * columns_ + x, b = a + 1, c = a + columns_, d = c + 1;
      const int corners = shown(a) + shown(b) + shown(c) + shown(d);
      if (corners < (cut_outlines_ ? 4 : 1)) continue;
      indices.insert(indices.end(), {a, c, b, b, c, d});
    }
  }
  glBufferData(GL_ELEMENT_ARRAY_BUFFER,
               static_cast<GLsizeiptr>(indices.size() * sizeof(std::uint32_t)), indices.data(),
               GL_DYNAMIC_DRAW);
  index_count_ = indices.size();
  shown_ = owners;
}

void ViewPass::cut_outlines(bool on) {
  if (on == cut_outlines_) return;
  cut_outlines_ = on;
  index_count_ = 0;  // made anew by the next draw
}

void ViewPass::draw(const Camera& camera, DepthMapping mapping, const DrawnView& drawn) {
  draw_calls_ = 0;
  if (columns_ == 0) return;
  glBindVertexArray(vao_.id());
  if (index_count_ == 0 || shown_ != drawn.owners) show(drawn.owners);
  if (index_count_ > 0) {
    program_.use();
    program_.set("u_clip_from_relative", camera.clip_from_relative(mapping));
    program_.set("u_offset", glm::vec3(eye_ - camera.pose.eye));
    program_.set("u_color", 0);
    glActiveTexture(GL_TEXTURE0);
    glBindTexture(GL_TEXTURE_2D, color_.id());
    glDisable(GL_CULL_FACE);
    glDrawElements(GL_TRIANGLES, static_cast<GLsizei>(index_count_), GL_UNSIGNED_INT, nullptr);
    draw_calls_ = 1;
  }
  glBindVertexArray(0);
}

}  // namespace mirage
