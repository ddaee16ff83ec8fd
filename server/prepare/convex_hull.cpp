#include "server/prepare/convex_hull.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "protocol/base/limits.h"

namespace mirage {
namespace {

std::vector<glm::dvec3> support_directions() {
  std::vector<glm::dvec3> out;
  for (int x = -1; x <= 1; ++x) {
    for (int y = -1; y <= 1; ++y) {
      for (int z = -1; z <= 1; ++z) {
        if (x || y || z) out.push_back(glm::normalize(glm::dvec3(x, y, z)));
      }
    }
  }
  return out;
}

/// A convex polygon, counter-clockwise from outside.
using Polygon = std::vector<glm::dvec3>;

constexpr double kSameCorner = 1e-6;  // corners nearer than this are one

// Returns a square around the middle of the plane, larger than any body that planes of such offsets
// enclose.
Polygon square_on(const glm::dvec3& normal, double offset) {
  constexpr double kHalf = 4;
  const glm::dvec3 aside = std::abs(normal.x) < 0.9 ? glm::dvec3(1, 0, 0) : glm::dvec3(0, 1, 0);
  const glm::dvec3 u = kHalf * glm::normalize(glm::cross(aside, normal));
  const glm::dvec3 v = glm::cross(normal, u);
  const glm::dvec3 middle = offset * normal;
  return {middle - u - v, middle + u - v, middle + u + v, middle - u + v};
}

// Clips a polygon to the inner side of a plane (Sutherland and Hodgman, "Reentrant polygon
// clipping", 1974).
void clip(const Polygon& in, const glm::dvec3& normal, double offset, Polygon& out) {
  out.clear();
  for (std::size_t i = 0; i < in.size(); ++i) {
    const glm::dvec3 &a = in[i], &b = in[(i + 1) % in.size()];
    const double beyond_a = glm::dot(normal, a) - offset, beyond_b = glm::dot(normal, b) - offset;
    if (beyond_a <= 0) out.push_back(a);
    if ((beyond_a <= 0) != (beyond_b <= 0)) {
      out.push_back(a + (b - a) * (beyond_a / (beyond_a - beyond_b)));
    }
  }
}

std::size_t index_of(const glm::dvec3& corner, std::vector<glm::dvec3>& vertices) {
  const auto at = std::find_if(vertices.begin(), vertices.end(), [&](const glm::dvec3& v) {
    return glm::dot(v - corner, v - corner) < kSameCorner * kSameCorner;
  });
  const auto index = static_cast<std::size_t>(at - vertices.begin());
  if (index == vertices.size()) vertices.push_back(corner);
  return index;
}

// The face of each plane is its square, clipped by all other planes.
ConvexHull intersect_half_spaces(const std::vector<glm::dvec3>& normals,
                                 const std::vector<double>& offsets) {
  std::vector<glm::dvec3> vertices;
  std::vector<std::size_t> triangles;
  Polygon face, clipped;
  for (std::size_t i = 0; i < normals.size(); ++i) {
    face = square_on(normals[i], offsets[i]);
    for (std::size_t k = 0; k < normals.size() && !face.empty(); ++k) {
      if (k == i) continue;
      clip(face, normals[k], offsets[k], clipped);
      face.swap(clipped);
    }
    std::vector<std::size_t> corners;
    for (const glm::dvec3& corner : face) {
      const std::size_t id = index_of(corner, vertices);
      if (std::find(corners.begin(), corners.end(), id) == corners.end()) corners.push_back(id);
    }
    for (std::size_t k = 2; k < corners.size(); ++k) {
      triangles.insert(triangles.end(), {corners[0], corners[k - 1], corners[k]});
    }
  }
  ConvexHull hull;
  for (const glm::dvec3& v : vertices) hull.vertices.emplace_back(v);
  for (const std::size_t id : triangles) hull.indices.push_back(static_cast<std::uint8_t>(id));
  return hull;
}

}  // namespace

Result<ConvexHull> enclosing_hull(const std::vector<glm::vec3>& points) {
  if (points.empty()) return ConvexHull{};
  glm::dvec3 low(points[0]), high(points[0]);
  for (const glm::vec3& p : points) {
    low = glm::min(low, glm::dvec3(p));
    high = glm::max(high, glm::dvec3(p));
  }
  const glm::dvec3 middle = 0.5 * (low + high);
  const double extent = std::max(glm::length(high - low), 1e-30);
  const std::vector<glm::dvec3> normals = support_directions();
  std::vector<double> offsets(normals.size(), 0.0);
  for (const glm::vec3& p : points) {
    const glm::dvec3 q = (glm::dvec3(p) - middle) / extent;
    for (std::size_t i = 0; i < normals.size(); ++i) {
      offsets[i] = std::max(offsets[i], glm::dot(normals[i], q));
    }
  }
  for (double& offset : offsets) offset += 1e-3;
  ConvexHull hull = intersect_half_spaces(normals, offsets);
  if (hull.vertices.size() > limits::kMaxHullVertices) {
    return make_error(ErrorId::kInternal, "hull has too many vertices");
  }
  for (glm::vec3& v : hull.vertices) v = glm::vec3(glm::dvec3(v) * extent + middle);
  hull.parallax.assign(hull.vertices.size(), 0.0f);
  return hull;
}

std::vector<float> parallax_factors(const ConvexHull& hull, const std::vector<glm::vec3>& points,
                                    const glm::vec3& center, const Workers& workers) {
  std::vector<float> out(hull.vertices.size());
  workers.each(out.size(), [&](std::size_t i) {
    const glm::vec3 vertex = hull.vertices[i], inwards = center - vertex;
    float nearest2 = std::numeric_limits<float>::infinity();
    for (const glm::vec3& p : points) {
      const glm::vec3 d = p - vertex;
      const float distance2 = glm::dot(d, d);
      if (distance2 < nearest2 && glm::dot(d, inwards) >= 0) nearest2 = distance2;
    }
    out[i] = std::isfinite(nearest2) ? std::sqrt(nearest2) : 0.0f;
  });
  return out;
}

}  // namespace mirage
