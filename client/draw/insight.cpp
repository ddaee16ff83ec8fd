#include "client/draw/insight.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <optional>

#include "client/frame/draw_list.h"
#include "client/hold/tile_cache.h"
#include "client/scene/scene_view.h"
#include "protocol/impostor/camera.h"

namespace mirage {
namespace {

using Color = std::array<float, 4>;
constexpr Color kFlat = {0.35f, 0.65f, 1, 0.9f}, kRelief = {0.3f, 0.95f, 0.4f, 0.9f},
                kMesh = {1, 0.85f, 0.2f, 0.9f}, kMissing = {1, 0.25f, 0.2f, 0.9f};
constexpr float kTint = 0.4f;  // opacity of a filled shape
constexpr double kOldUs = 60e6;
constexpr float kLinePx = 1.5f;
constexpr std::size_t kCorners = 24;  // corners of a disc

struct InsightVertex {
  float x, y;
  Color color;
};

struct Disc {
  glm::dvec2 center{0};  // clip space
  glm::dvec2 radius{0};
};

// Returns the square around a sphere in the view; nullopt: it is behind the eye, or around it.
std::optional<Disc> disc_of(const Camera& camera, const InstanceView& instance) {
  const glm::dvec3 to = instance.center - camera.pose.eye;
  const double z = glm::dot(to, camera.forward());
  if (z <= instance.radius) return std::nullopt;
  const double tan_y = std::tan(0.5 * camera.fov_y);
  const double tan_x = tan_y * camera.width / camera.height;
  const double reach = instance.radius / std::sqrt(z * z - instance.radius * instance.radius);
  return Disc{{glm::dot(to, camera.right()) / (z * tan_x), glm::dot(to, camera.up()) / (z * tan_y)},
              {reach / tan_x, reach / tan_y}};
}

class Shapes {
 public:
  explicit Shapes(const Camera& camera) : camera_(camera) {}

  void outline(const InstanceView& instance, const Color& color) {
    const std::optional<Disc> disc = disc_of(camera_, instance);
    if (!disc) return;
    const double w = 2.0 * kLinePx / camera_.width, h = 2.0 * kLinePx / camera_.height;
    const glm::dvec2 low = disc->center - disc->radius, high = disc->center + disc->radius;
    box(low, {high.x, low.y + h}, color);
    box({low.x, high.y - h}, high, color);
    box(low, {low.x + w, high.y}, color);
    box({high.x - w, low.y}, high, color);
  }
  void fill(const InstanceView& instance, Color color) {
    const std::optional<Disc> disc = disc_of(camera_, instance);
    if (!disc) return;
    color[3] = kTint;
    const auto corner = [&](std::size_t i) {
      const double a = 6.283185307179586 * static_cast<double>(i) / kCorners;
      return disc->center + disc->radius * glm::dvec2(std::cos(a), std::sin(a));
    };
    for (std::size_t i = 0; i < kCorners; ++i) {
      put(disc->center, color);
      put(corner(i), color);
      put(corner(i + 1), color);
    }
  }
  const std::vector<InsightVertex>& vertices() const { return vertices_; }

 private:
  void put(const glm::dvec2& at, const Color& color) {
    vertices_.push_back({static_cast<float>(at.x), static_cast<float>(at.y), color});
  }
  void box(const glm::dvec2& low, const glm::dvec2& high, const Color& color) {
    for (const glm::dvec2& at : {low, {high.x, low.y}, high, low, high, {low.x, high.y}}) {
      put(at, color);
    }
  }

  const Camera& camera_;
  std::vector<InsightVertex> vertices_;
};

bool flat(DrawMethod method) {
  return method == DrawMethod::kQuad || method == DrawMethod::kCuboid ||
         method == DrawMethod::kHull;
}

void add_borders(const SceneView& scene, const DrawList& list, Shapes& shapes) {
  for (const DrawnMesh& drawn : list.meshes) {
    shapes.outline(scene.instances[drawn.instance], kMesh);
  }
  for (const DrawnImpostor& drawn : list.impostors) {
    shapes.outline(scene.instances[drawn.instance], flat(drawn.method) ? kFlat : kRelief);
  }
  for (const DrawnPlaceholder& drawn : list.placeholders) {
    shapes.outline(scene.instances[drawn.instance], kMissing);
  }
}

void add_tints(InsightLayer layer, const SceneView& scene, const DrawList& list, double tau_px,
               std::int64_t now_us, Shapes& shapes) {
  for (const DrawnImpostor& drawn : list.impostors) {
    const double share = layer == InsightLayer::kBound
                             ? 0.5 * drawn.bound_px / std::max(tau_px, 1e-6)
                             : static_cast<double>(now_us - drawn.tile->received_us) / kOldUs;
    shapes.fill(scene.instances[drawn.instance], heat(share));
  }
  if (layer != InsightLayer::kBound) return;
  for (const DrawnPlaceholder& drawn : list.placeholders) {
    shapes.fill(scene.instances[drawn.instance], heat(1));
  }
}

}  // namespace

std::array<float, 4> heat(double share) {
  const auto x = static_cast<float>(std::isfinite(share) ? std::clamp(share, 0.0, 1.0) : 1.0);
  return {std::min(1.0f, 2 * x), std::min(1.0f, 2 - 2 * x), 0.1f, 1};
}

Result<Insight> Insight::create() {
  Insight out;
  Result<gl::Program> program =
      gl::Program::create("overlay/insight.vert", "overlay/insight.frag", {});
  if (!program) return program.error();
  out.program_ = program.take();
  out.vao_ = gl::VertexArray::create();
  out.vertices_ = gl::Buffer::create();
  glBindVertexArray(out.vao_.id());
  glBindBuffer(GL_ARRAY_BUFFER, out.vertices_.id());
  glEnableVertexAttribArray(0);
  glVertexAttribPointer(0, 2, GL_FLOAT, GL_FALSE, sizeof(InsightVertex), nullptr);
  glEnableVertexAttribArray(1);
  glVertexAttribPointer(1, 4, GL_FLOAT, GL_FALSE, sizeof(InsightVertex),
                        reinterpret_cast<const void*>(offsetof(InsightVertex, color)));
  glBindVertexArray(0);
  return out;
}

void Insight::draw(InsightLayer layer, const Camera& camera, const SceneView& scene,
                   const DrawList& list, double tau_px, std::int64_t now_us) {
  Shapes shapes(camera);
  switch (layer) {
    case InsightLayer::kNone:
      return;
    case InsightLayer::kBorders:
      add_borders(scene, list, shapes);
      break;
    case InsightLayer::kBound:
    case InsightLayer::kAge:
      add_tints(layer, scene, list, tau_px, now_us, shapes);
      break;
    case InsightLayer::kGeometry:
      for (const DrawnMesh& drawn : list.meshes) {
        shapes.fill(scene.instances[drawn.instance], kMesh);
      }
      break;
  }
  const std::vector<InsightVertex>& vertices = shapes.vertices();
  if (vertices.empty()) return;
  glViewport(0, 0, static_cast<GLsizei>(camera.width), static_cast<GLsizei>(camera.height));
  glDisable(GL_DEPTH_TEST);
  glDisable(GL_CULL_FACE);
  glEnable(GL_BLEND);
  glBlendFunc(GL_SRC_ALPHA, GL_ONE_MINUS_SRC_ALPHA);
  program_.use();
  glBindVertexArray(vao_.id());
  glBindBuffer(GL_ARRAY_BUFFER, vertices_.id());
  glBufferData(GL_ARRAY_BUFFER, static_cast<GLsizeiptr>(vertices.size() * sizeof(InsightVertex)),
               vertices.data(), GL_STREAM_DRAW);
  glDrawArrays(GL_TRIANGLES, 0, static_cast<GLsizei>(vertices.size()));
  glBindVertexArray(0);
  glDisable(GL_BLEND);
  glEnable(GL_DEPTH_TEST);
}

}  // namespace mirage
