#include "protocol/impostor/object_proxy.h"

#include <algorithm>
#include <limits>

namespace mirage {

std::vector<Plane> ConvexHull::planes() const {
  std::vector<Plane> out;
  for (std::size_t i = 0; i + 2 < indices.size(); i += 3) {
    const glm::dvec3 a(vertices[indices[i]]);
    const glm::dvec3 n = glm::cross(glm::dvec3(vertices[indices[i + 1]]) - a,
                                    glm::dvec3(vertices[indices[i + 2]]) - a);
    const double length = glm::length(n);
    if (!(length > 0)) continue;
    Plane plane{n / length, glm::dot(n / length, a)};
    for (const glm::vec3& v : vertices) {
      plane.offset = std::max(plane.offset, glm::dot(plane.normal, glm::dvec3(v)));
    }
    out.push_back(plane);
  }
  return out;
}

std::vector<Plane> box_planes(const glm::vec3& box_min, const glm::vec3& box_max) {
  std::vector<Plane> out;
  for (int axis = 0; axis < 3; ++axis) {
    glm::dvec3 n(0);
    n[axis] = 1;
    out.push_back({n, double{box_max[axis]}});
    out.push_back({-n, -double{box_min[axis]}});
  }
  return out;
}

// A face with normal n at p looks away if dot(n, p - eye) >= 0. That holds for all normals of the
// cone if p - eye is within 90 degrees less the cone's half angle of its axis. Such p - eye are a
// convex cone: it holds all points of the hull if it holds its corners.
bool faces_away(const ObjectDescription& object, const glm::dvec3& eye) {
  if (!(object.faces.sine < 1) || object.hull.vertices.empty()) return false;
  const glm::dvec3 axis(object.faces.axis), from = eye + glm::dvec3(object.center);
  return std::all_of(object.hull.vertices.begin(), object.hull.vertices.end(),
                     [&](const glm::vec3& corner) {
                       const glm::dvec3 way = glm::dvec3(corner) - from;
                       return glm::dot(way, axis) >= double{object.faces.sine} * glm::length(way);
                     });
}

double ray_entry(const std::vector<Plane>& planes, const glm::dvec3& origin,
                 const glm::dvec3& direction) {
  double enter = 0, leave = std::numeric_limits<double>::infinity();
  for (const Plane& plane : planes) {
    const double speed = glm::dot(plane.normal, direction);
    const double gap = plane.offset - glm::dot(plane.normal, origin);
    if (speed < 0) {
      enter = std::max(enter, gap / speed);
    } else if (speed > 0) {
      leave = std::min(leave, gap / speed);
    } else if (gap < 0) {
      return -1;
    }
  }
  return enter <= leave ? enter : -1;
}

float box_parallax(const ObjectDescription& object) {
  // The ellipsoid reaches, towards a corner, 1 / sqrt(3) of the half diagonal.
  constexpr float kLeft = 1.0f - 0.57735027f;
  return kLeft * 0.5f * glm::length(object.box_max - object.box_min);
}

double hull_extent(const ObjectDescription& object) {
  double extent = 0;
  for (const glm::vec3& v : object.hull.vertices) {
    extent = std::max(extent, glm::length(glm::dvec3(v) - glm::dvec3(object.center)));
  }
  return extent;
}

double box_extent(const ObjectDescription& object) {
  const glm::dvec3 low = glm::abs(glm::dvec3(object.box_min) - glm::dvec3(object.center));
  const glm::dvec3 high = glm::abs(glm::dvec3(object.box_max) - glm::dvec3(object.center));
  return glm::length(glm::max(low, high));
}

}  // namespace mirage
