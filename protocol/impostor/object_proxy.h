#pragma once
// An object as the client knows it before any tile: its bounds, and the proxies that tiles are
// drawn on.

#include <cstdint>
#include <glm/glm.hpp>
#include <string>
#include <vector>

#include "protocol/impostor/lod.h"
#include "protocol/impostor/motion.h"
#include "protocol/model/need_mask.h"

namespace mirage {

struct Plane {
  glm::dvec3 normal{0, 0, 1};  ///< outward, unit
  double offset = 0;           ///< dot(normal, x) <= offset inside
};

struct ConvexHull {
  std::vector<glm::vec3> vertices;    ///< object space
  std::vector<std::uint8_t> indices;  ///< triangles, counter-clockwise from outside
  /// Per vertex, object units: distance from the vertex back to the mesh (TECHNIQUES row 15).
  std::vector<float> parallax;
  /// Returns the plane of each triangle that has an area, moved outwards until it cuts off no
  /// vertex: vertices are rounded, and the plane of a triangle hardly wider than the rounding
  /// leans.
  std::vector<Plane> planes() const;
};

/// The directions that an object's one-sided faces look in: a cone.
struct FacingCone {
  glm::vec3 axis{0};  ///< unit; object space
  float sine = 1;     ///< of half its angle, 0 to 1; 1: some face is seen from everywhere
};

struct ObjectDescription {
  std::string
      name;  ///< as the file has it, at most limits::kMaxObjectNameBytes; empty: it has none
  glm::vec3 center{0};  ///< of the bounding sphere, object space
  float radius = 0;
  glm::vec3 box_min{0};
  glm::vec3 box_max{0};
  ConvexHull hull;             ///< encloses the mesh
  glm::vec3 mean_color{0.5f};  ///< linear; what a placeholder shows
  float opacity = 1;           ///< 0 to 1: mean of its surfaces; what a placeholder covers
  FacingCone faces;
  NeedMask needs = 0;
  std::uint32_t triangles = 0;
  std::vector<LodInfo> lods;  ///< finest first; at least one when there is geometry
  MotionProfile motion;       ///< bounds and hull enclose every pose
  Track track;                ///< where all of this is at a time; at rest: at its instance
  bool surrounds = false;     ///< large scenery that exists once: drawn as geometry from the start
  bool group = false;         ///< stands for all instances of a spatial cell, for far views
  bool part = false;          ///< one part of a cut instance; it is no group
  bool cut = false;           ///< near the eye, its only instance may be drawn as parts

  /// True if it casts a shadow. Moving objects do not: no key says where they are at which time.
  bool casts() const { return (needs & kNeedShadowPass) && radius > 0 && !moves(); }
  /// True if its picture changes by itself.
  bool moves() const { return motion.moving() || track.moves(); }
};

/// True if all faces of the object look away from `eye`, so that nothing of it is seen. `eye`:
/// object space, relative to the centre.
bool faces_away(const ObjectDescription& object, const glm::dvec3& eye);

/// Returns the distance from a corner of the box inwards to the ellipsoid inscribed in the box.
/// It is the parallax factor of an object without a hull.
float box_parallax(const ObjectDescription& object);

/// Returns the six planes of a box.
std::vector<Plane> box_planes(const glm::vec3& box_min, const glm::vec3& box_max);

/// Returns t where the ray origin + t * direction enters the convex body; negative if it misses.
double ray_entry(const std::vector<Plane>& planes, const glm::dvec3& origin,
                 const glm::dvec3& direction);

/// Returns the largest distance of a hull vertex or box corner from the centre: the q of the bound.
double hull_extent(const ObjectDescription& object);
double box_extent(const ObjectDescription& object);

}  // namespace mirage
