#include "server/scene/gltf/staging.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <glm/gtc/quaternion.hpp>
#include <limits>

#include "protocol/base/limits.h"

namespace mirage::gltf {
namespace {

constexpr std::size_t kMostPoints = 300'000;         // looked at for the home view
constexpr std::size_t kMostTriangles = 2'000'000;    // looked at for the shadow
constexpr double kShadowReach = 2;                   // half of the shadow's square, in half extents
constexpr double kNear = 0.08, kFar = 0.4;           // heights in which shadows fade, the same
constexpr float kNearDark = 0.55f, kFarDark = 0.3f;  // share of the light that they take
constexpr int kNearBlur = 1, kFarBlur = 4;           // cells

using Triangle = std::array<glm::dvec3, 3>;

/// Calls `visit` for triangles of the scene, about `most` at most, in world space.
void for_triangles(const Scene& scene, std::size_t most,
                   const std::function<void(const Triangle&)>& visit) {
  std::size_t all = 0;
  for (const Instance& instance : scene.instances) {
    all += scene.objects[instance.object].mesh.indices.size() / 3;
  }
  const std::size_t stride = std::max<std::size_t>(1, all / most);
  std::vector<std::vector<glm::vec3>> shown(scene.objects.size());
  std::size_t next = 0;  // counts over all instances, so that none is left out as a whole
  for (const Instance& instance : scene.instances) {
    const std::vector<std::uint32_t>& indices = scene.objects[instance.object].mesh.indices;
    std::vector<glm::vec3>& positions = shown[instance.object];
    if (positions.empty()) positions = shown_positions(scene.objects[instance.object]);
    const Similarity& world = instance.world_from_object;
    const glm::dmat3 turn = glm::mat3_cast(glm::dquat(world.rotation)) * double{world.scale};
    const std::size_t triangles = indices.size() / 3;
    for (; next < triangles; next += stride) {
      Triangle corners;
      for (std::size_t c = 0; c < 3; ++c) {
        corners[c] = world.position + turn * glm::dvec3(positions[indices[3 * next + c]]);
      }
      visit(corners);
    }
    next -= triangles;
  }
}

/// Returns direction `i` of kMaxFitPoints that are spread evenly over the sphere (Fibonacci).
glm::dvec3 spread_direction(std::size_t i) {
  constexpr double kGoldenAngle = 2.399963229728653;
  const double y = 1 - (2.0 * static_cast<double>(i) + 1) / limits::kMaxFitPoints;
  const double across = std::sqrt(1 - y * y), angle = kGoldenAngle * static_cast<double>(i);
  return {across * std::cos(angle), y, across * std::sin(angle)};
}

/// Values by cell of the floor.
using Cells = std::vector<float>;
constexpr int kEdge = StudioFloor::kEdge;

float at(const Cells& cells, int x, int z) {
  const bool inside = x >= 0 && z >= 0 && x < kEdge && z < kEdge;
  return inside ? cells[static_cast<std::size_t>(z * kEdge + x)] : 0;
}

/// Returns the means over squares of 2 `reach` + 1 cells a side, three times over: about a
/// Gaussian.
Cells blurred(Cells cells, int reach) {
  for (int pass = 0; pass < 6; ++pass) {
    Cells out(cells.size());
    for (int z = 0; z < kEdge; ++z) {
      for (int x = 0; x < kEdge; ++x) {
        float sum = 0;
        for (int d = -reach; d <= reach; ++d) {
          sum += pass % 2 == 0 ? at(cells, x + d, z) : at(cells, x, z + d);
        }
        out[static_cast<std::size_t>(z * kEdge + x)] = sum / static_cast<float>(2 * reach + 1);
      }
    }
    cells = std::move(out);
  }
  return cells;
}

/// Lowers the heights of the cells that a triangle lies over.
void add_triangle(const Triangle& t, const StudioFloor& floor, Cells& heights) {
  const double cell = 2.0 * floor.half / kEdge;
  double longest = 0;
  for (std::size_t c = 0; c < 3; ++c) {
    const glm::dvec3 side = t[(c + 1) % 3] - t[c];
    longest = std::max({longest, std::abs(side.x), std::abs(side.z)});
  }
  const int steps = std::clamp(static_cast<int>(std::ceil(2 * longest / cell)), 1, 4 * kEdge);
  for (int i = 0; i <= steps; ++i) {
    for (int k = 0; k <= steps - i; ++k) {
      const double u = static_cast<double>(i) / steps, v = static_cast<double>(k) / steps;
      const glm::dvec3 p = t[0] + u * (t[1] - t[0]) + v * (t[2] - t[0]) - floor.center;
      const double x = (p.x + floor.half) / cell, z = (p.z + floor.half) / cell;
      if (!(x >= 0 && z >= 0 && x < kEdge && z < kEdge)) continue;
      float& height = heights[static_cast<std::size_t>(z) * kEdge + static_cast<std::size_t>(x)];
      height = std::min(height, static_cast<float>(std::max(p.y, 0.0)));
    }
  }
}

}  // namespace

std::vector<glm::vec3> outermost_points(const Scene& scene, const Bounds& frame) {
  std::array<glm::dvec3, limits::kMaxFitPoints> directions;
  std::array<double, limits::kMaxFitPoints> farthest;
  std::array<glm::vec3, limits::kMaxFitPoints> points{};
  for (std::size_t i = 0; i < directions.size(); ++i) directions[i] = spread_direction(i);
  farthest.fill(-1);
  const glm::dvec3 middle = frame.center();
  for_triangles(scene, kMostPoints / 3, [&](const Triangle& triangle) {
    for (const glm::dvec3& corner : triangle) {
      if (glm::any(glm::lessThan(corner, frame.low)) || glm::any(glm::lessThan(frame.high, corner)))
        continue;
      for (std::size_t i = 0; i < directions.size(); ++i) {
        const double out = glm::dot(corner - middle, directions[i]);
        if (out <= farthest[i]) continue;
        farthest[i] = out;
        points[i] = glm::vec3(corner - middle);
      }
    }
  });
  std::vector<glm::vec3> out;
  for (std::size_t i = 0; i < points.size(); ++i) {
    const bool told = std::find(out.begin(), out.end(), points[i]) != out.end();
    if (farthest[i] >= 0 && !told) out.push_back(points[i]);
  }
  return out;
}

StudioFloor floor_under(const Scene& scene, const Bounds& frame) {
  StudioFloor floor;
  const glm::dvec3 half = 0.5 * (frame.high - frame.low);
  const double extent = std::max({half.x, half.y, half.z});
  floor.center = {frame.center().x, frame.low.y, frame.center().z};
  floor.half = static_cast<float>(kShadowReach * std::max({half.x, half.z, 0.25 * half.y}));
  if (!(floor.half > 0) || !std::isfinite(floor.half)) return {};
  Cells heights(static_cast<std::size_t>(kEdge) * kEdge, std::numeric_limits<float>::infinity());
  for_triangles(scene, kMostTriangles,
                [&](const Triangle& triangle) { add_triangle(triangle, floor, heights); });
  Cells near, far;
  for (const float height : heights) {
    near.push_back(std::exp(-height / static_cast<float>(kNear * extent)));
    far.push_back(std::exp(-height / static_cast<float>(kFar * extent)));
  }
  near = blurred(std::move(near), kNearBlur);
  far = blurred(std::move(far), kFarBlur);
  for (int z = 0; z < kEdge; ++z) {
    for (int x = 0; x < kEdge; ++x) {
      const std::size_t i = static_cast<std::size_t>(z * kEdge + x);
      const auto place = [](int cell) { return (2.0f * static_cast<float>(cell) + 1) / kEdge - 1; };
      const float away = std::hypot(place(x), place(z));  // the shadow ends within the square
      const float fade = 1 - glm::smoothstep(0.7f, 0.97f, away);
      const float taken = fade * (kNearDark * near[i] + kFarDark * far[i]);
      floor.shadow.push_back(static_cast<std::uint8_t>(std::lround(255 * std::min(taken, 1.0f))));
    }
  }
  return floor;
}

}  // namespace mirage::gltf
