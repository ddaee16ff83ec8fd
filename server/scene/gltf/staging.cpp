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
constexpr std::int64_t kMostPlaces = 60'000'000;     // under all triangles: a second at most
constexpr double kShadowReach = 2;                   // half of the shadow's square, in half extents
constexpr double kNear = 0.08, kFar = 0.4;           // heights in which shadows fade, the same
constexpr float kNearDark = 0.55f, kFarDark = 0.3f;  // share of the light that they take
constexpr int kNearBlur = 1, kFarBlur = 4;           // cells

using Triangle = std::array<glm::dvec3, 3>;

/// Calls `visit` for triangles of the scene, about `most` at most, in world space. Ends of lines,
/// and points, are triangles without size.
void for_triangles(const Scene& scene, std::size_t most,
                   const std::function<void(const Triangle&)>& visit) {
  std::size_t all = 0;
  for (const Instance& instance : scene.instances) {
    all += scene.objects[instance.object].mesh.indices.size() / 3;
  }
  const std::size_t stride = std::max<std::size_t>(1, all / most);
  ShownPositions shown(scene);
  std::size_t next = 0;  // counts on from primitive to primitive, so that none is left out for ever
  for (const Instance& instance : scene.instances) {
    const Mesh& mesh = scene.objects[instance.object].mesh;
    const Similarity& world = instance.world_from_object;
    const glm::dmat3 turn = glm::mat3_cast(glm::dquat(world.rotation)) * double{world.scale};
    for (const Primitive& primitive : mesh.primitives) {
      const bool filled = primitive.kind == PrimitiveKind::kTriangles;
      const std::size_t triangles = primitive.index_count / 3;
      for (; next < triangles; next += stride) {
        const std::uint32_t* const corner = &mesh.indices[primitive.first_index + 3 * next];
        Triangle corners;
        for (std::size_t c = 0; c < 3; ++c) {
          corners[c] =
              world.position + turn * glm::dvec3(shown.at(instance.object, corner[filled ? c : 0]));
        }
        visit(corners);
      }
      next -= std::min(next, triangles);
    }
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

/// Lowers the heights of the cells that a triangle lies over. Takes the places that it looks at
/// from `left`, and does nothing once they are used up.
void add_triangle(const Triangle& t, const StudioFloor& floor, std::int64_t& left, Cells& heights) {
  const double cell = 2.0 * floor.half / kEdge;
  double longest = 0;
  for (std::size_t c = 0; c < 3; ++c) {
    const glm::dvec3 side = t[(c + 1) % 3] - t[c];
    longest = std::max({longest, std::abs(side.x), std::abs(side.z)});
  }
  const int steps = static_cast<int>(std::clamp(std::ceil(2 * longest / cell), 0.0, 4.0 * kEdge));
  left -= (steps + 1) * (steps + 2) / 2;
  if (left < 0) return;
  for (int i = 0; i <= steps; ++i) {
    for (int k = 0; k <= steps - i; ++k) {
      const double u = static_cast<double>(i) / std::max(steps, 1);
      const double v = static_cast<double>(k) / std::max(steps, 1);
      const glm::dvec3 p = t[0] + u * (t[1] - t[0]) + v * (t[2] - t[0]) - floor.center;
      const double x = (p.x + floor.half) / cell, z = (p.z + floor.half) / cell;
      if (!(x >= 0 && z >= 0 && x < kEdge && z < kEdge)) continue;
      float& height = heights[static_cast<std::size_t>(z) * kEdge + static_cast<std::size_t>(x)];
      height = std::min(height, static_cast<float>(std::max(p.y, 0.0)));
    }
  }
}

/// Calls `visit` with world points of what moves by a clip, in several of its poses.
template <typename Visit>
void for_moved_points(const Scene& scene, std::size_t most, const Visit& visit) {
  constexpr int kPoses = 8;
  std::vector<glm::vec3> posed;
  std::size_t left = most;
  for (const Instance& instance : scene.instances) {
    const SceneObject& object = scene.objects[instance.object];
    const std::size_t count = object.mesh.vertices.size() * kPoses;
    if (!object.animation || count > left) continue;
    left -= count;
    const Similarity& world = instance.world_from_object;
    const glm::dmat3 turn = glm::mat3_cast(glm::dquat(world.rotation)) * double{world.scale};
    for (int i = 0; i < kPoses; ++i) {
      const double time = object.animation->clip_s * static_cast<double>(i) / kPoses;
      pose_positions(object.mesh.vertices, *object.animation, time, posed);
      for (const glm::vec3& point : posed) visit(world.position + turn * glm::dvec3(point));
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
  const auto add = [&](const glm::dvec3& point) {
    for (std::size_t i = 0; i < directions.size(); ++i) {
      const double out = glm::dot(point - middle, directions[i]);
      if (out <= farthest[i]) continue;
      farthest[i] = out;
      points[i] = glm::vec3(point - middle);
    }
  };
  const auto within = [](const glm::dvec3& point, const glm::dvec3& low, const glm::dvec3& high) {
    return glm::all(glm::lessThanEqual(low, point)) && glm::all(glm::lessThanEqual(point, high));
  };
  for_triangles(scene, kMostPoints / 3, [&](const Triangle& triangle) {
    for (const glm::dvec3& corner : triangle) {
      if (within(corner, frame.low, frame.high)) add(corner);
    }
  });
  // A fox that lifts its head leaves the box of its first pose. Who walks away is not followed.
  const glm::dvec3 reach = 0.25 * (frame.high - frame.low);
  for_moved_points(scene, kMostPoints, [&](const glm::dvec3& point) {
    if (within(point, frame.low - reach, frame.high + reach)) add(point);
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
  std::int64_t left = kMostPlaces;
  for_triangles(scene, kMostTriangles,
                [&](const Triangle& triangle) { add_triangle(triangle, floor, left, heights); });
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
