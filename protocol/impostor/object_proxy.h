#pragma once
// An object as the client knows it before any tile: bounds and the proxies tiles are drawn on.

#include <cstdint>
#include <glm/glm.hpp>
#include <vector>

#include "protocol/impostor/lod.h"
#include "protocol/impostor/motion.h"
#include "protocol/model/need_mask.h"

namespace mirage {

struct Plane {
  glm::vec3 normal{0, 0, 1};  ///< outward, unit
  float offset = 0;           ///< dot(normal, x) <= offset inside
};

struct ConvexHull {
  std::vector<glm::vec3> vertices;    ///< object space
  std::vector<std::uint8_t> indices;  ///< triangles, counter-clockwise from outside
  /// Per vertex, object units: how far behind it the mesh begins (TECHNIQUES row 15).
  std::vector<float> parallax;
  std::vector<Plane> planes() const;
};

struct ObjectDescription {
  glm::vec3 center{0};  ///< of the bounding sphere, object space
  float radius = 0;
  glm::vec3 box_min{0};
  glm::vec3 box_max{0};
  ConvexHull hull;             ///< encloses the mesh
  glm::vec3 mean_color{0.5f};  ///< linear; what a placeholder shows
  NeedMask needs = 0;
  std::uint32_t triangles = 0;
  std::vector<LodInfo> lods;  ///< finest first; at least one when there is geometry
  MotionProfile motion;       ///< bounds and hull enclose every pose
  bool surrounds = false;     ///< large scenery that exists once: geometry from the start
  bool group = false;         ///< all instances of a spatial cell, for far views
  bool part = false;          ///< such a part; it is no group
  bool cut = false;           ///< its one instance may be shown as parts, to an eye close to it

  /// It throws a shadow. What moves does not: where it is when, no key says.
  bool casts() const { return (needs & kNeedShadowPass) && radius > 0 && !motion.moving(); }
};

/// How far behind a corner of the box the ellipsoid that touches all its faces begins: the parallax
/// factor of an object without a hull.
float box_parallax(const ObjectDescription& object);

/// The six planes of a box.
std::vector<Plane> box_planes(const glm::vec3& box_min, const glm::vec3& box_max);

/// Where the ray origin + t * direction enters the convex body; negative when it misses.
double ray_entry(const std::vector<Plane>& planes, const glm::dvec3& origin,
                 const glm::dvec3& direction);

/// Largest distance of a hull vertex or box corner from the centre: the q of the bound.
double hull_extent(const ObjectDescription& object);
double box_extent(const ObjectDescription& object);

}  // namespace mirage
