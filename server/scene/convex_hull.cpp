#include "server/scene/convex_hull.h"

#include <libqhullcpp/Qhull.h>
#include <libqhullcpp/QhullFacetList.h>
#include <libqhullcpp/QhullVertexSet.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "protocol/limits.h"

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

std::vector<double> flat(const std::vector<glm::dvec3>& points) {
  std::vector<double> out;
  for (const glm::dvec3& p : points) out.insert(out.end(), {p.x, p.y, p.z});
  return out;
}

// Each facet of the dual points' hull is a vertex of the intersection of half-spaces.
std::vector<glm::dvec3> intersect_half_spaces(const std::vector<glm::dvec3>& normals,
                                              const std::vector<double>& offsets) {
  std::vector<glm::dvec3> dual;
  for (std::size_t i = 0; i < normals.size(); ++i) dual.push_back(normals[i] / offsets[i]);
  const std::vector<double> coordinates = flat(dual);
  orgQhull::Qhull qhull("", 3, static_cast<int>(dual.size()), coordinates.data(), "Qt");
  std::vector<glm::dvec3> vertices;
  for (const orgQhull::QhullFacet& facet : qhull.facetList()) {
    const orgQhull::QhullHyperplane plane = facet.hyperplane();
    const double offset = -plane.offset();
    const glm::dvec3 v = glm::dvec3(plane[0], plane[1], plane[2]) / offset;
    const auto near_v = [&](const glm::dvec3& w) { return glm::length(v - w) < 1e-6; };
    if (std::none_of(vertices.begin(), vertices.end(), near_v)) vertices.push_back(v);
  }
  return vertices;
}

ConvexHull triangulated_hull(const std::vector<glm::dvec3>& points) {
  const std::vector<double> coordinates = flat(points);
  orgQhull::Qhull qhull("", 3, static_cast<int>(points.size()), coordinates.data(), "Qt");
  ConvexHull hull;
  for (const glm::dvec3& p : points) hull.vertices.emplace_back(p);
  for (const orgQhull::QhullFacet& facet : qhull.facetList()) {
    const orgQhull::QhullVertexSet corners = facet.vertices();
    if (corners.size() != 3) continue;
    int ids[3];
    for (int i = 0; i < 3; ++i) ids[i] = corners[i].point().id();
    const orgQhull::QhullHyperplane plane = facet.hyperplane();
    const glm::dvec3 n(plane[0], plane[1], plane[2]);
    const glm::dvec3 a = points[static_cast<std::size_t>(ids[0])];
    const glm::dvec3 b = points[static_cast<std::size_t>(ids[1])];
    const glm::dvec3 c = points[static_cast<std::size_t>(ids[2])];
    if (glm::dot(glm::cross(b - a, c - a), n) < 0) std::swap(ids[1], ids[2]);
    for (const int id : ids) hull.indices.push_back(static_cast<std::uint8_t>(id));
  }
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
  try {
    const std::vector<glm::dvec3> vertices = intersect_half_spaces(normals, offsets);
    if (vertices.size() > limits::kMaxHullVertices) {
      return make_error(ErrorId::kInternal, "hull has too many vertices");
    }
    ConvexHull hull = triangulated_hull(vertices);
    for (glm::vec3& v : hull.vertices) v = glm::vec3(glm::dvec3(v) * extent + middle);
    hull.parallax.assign(hull.vertices.size(), 0.0f);
    return hull;
  } catch (const std::exception& e) {
    return make_error(ErrorId::kInternal, std::string("qhull: ") + e.what());
  }
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
