#include "server/scene/similarity_split.h"

#include <algorithm>
#include <cmath>
#include <glm/gtc/quaternion.hpp>

#include "server/scene/unit_vectors.h"

namespace mirage {
namespace {

constexpr double kResidualTolerance = 1e-5;
constexpr double kSingular = 1e-12;  // |det| of a matrix whose longest column is 1
constexpr int kPolarSteps = 60;
constexpr float kSmallestScale = 1e-36f;
constexpr float kLargestScale = 1e36f;

double longest_column(const glm::dmat3& m) {
  return std::max({glm::length(m[0]), glm::length(m[1]), glm::length(m[2])});
}

double largest_difference(const glm::dmat3& a, const glm::dmat3& b) {
  double largest = 0;
  for (int c = 0; c < 3; ++c) {
    for (int r = 0; r < 3; ++r) largest = std::max(largest, std::abs(a[c][r] - b[c][r]));
  }
  return largest;
}

glm::dmat3 cofactors(const glm::dmat3& m) {
  return {glm::cross(m[1], m[2]), glm::cross(m[2], m[0]), glm::cross(m[0], m[1])};
}

/// Returns the orthogonal factor of a non-singular matrix (Higham 1986, Newton with determinant
/// scaling).
glm::dmat3 orthogonal_factor(glm::dmat3 q) {
  for (int step = 0; step < kPolarSteps; ++step) {
    const double determinant = glm::determinant(q);
    const double scale = 1 / std::cbrt(std::abs(determinant));
    const glm::dmat3 inverse_transpose = cofactors(q) / determinant;
    const glm::dmat3 next = 0.5 * (scale * q + inverse_transpose / scale);
    const double change = largest_difference(next, q);
    q = next;
    if (change < 1e-15) break;
  }
  return q;
}

/// Returns the normal of the plane that a singular map flattens everything into.
glm::dvec3 plane_normal(const glm::dmat3& cofactor) {
  glm::dvec3 longest = cofactor[0];
  for (int c = 1; c < 3; ++c) {
    if (glm::length(cofactor[c]) > glm::length(longest)) longest = cofactor[c];
  }
  return longest;
}

}  // namespace

void swap_winding(Mesh& mesh) {
  for (const Primitive& primitive : mesh.primitives) {
    if (primitive.kind != PrimitiveKind::kTriangles) continue;
    const std::size_t end = primitive.first_index + primitive.index_count;
    for (std::size_t i = primitive.first_index; i + 3 <= end; i += 3) {
      std::swap(mesh.indices[i + 1], mesh.indices[i + 2]);
    }
  }
}

SplitTransform split_transform(const glm::dmat4& matrix) {
  SplitTransform out;
  out.similarity.position = glm::dvec3(matrix[3]);
  const glm::dmat3 linear(matrix);
  const double scale = longest_column(linear);
  if (!(scale >= kSmallestScale) || scale > kLargestScale) {
    // The scale is 0 or too small for a float: everything falls into one point.
    out.residual = scale > kLargestScale ? linear / scale : glm::dmat3(0);
    out.similarity.scale = scale > kLargestScale ? kLargestScale : 1.0f;
    out.has_residual = true;
    return out;
  }
  out.similarity.scale = static_cast<float>(scale);
  const glm::dmat3 shape = linear / static_cast<double>(out.similarity.scale);
  const double determinant = glm::determinant(shape);
  if (std::abs(determinant) < kSingular) {
    out.residual = shape;
    out.has_residual = true;
    return out;
  }
  glm::dmat3 rotation = orthogonal_factor(shape);
  // A fixed mirror turns an improper factor into a rotation; all mirrored copies share it.
  if (determinant < 0) rotation[0] = -rotation[0];
  out.similarity.rotation = glm::normalize(glm::quat(glm::quat_cast(rotation)));
  out.residual = glm::transpose(rotation) * shape;
  out.has_residual = largest_difference(out.residual, glm::dmat3(1)) > kResidualTolerance;
  return out;
}

Mesh bake(const Mesh& mesh, const glm::dmat3& residual) {
  Mesh out = mesh;
  const double determinant = glm::determinant(residual);
  const double side = determinant < 0 ? -1 : 1;
  const glm::dmat3 cofactor = cofactors(residual) * side;
  const glm::vec3 plane = unit_or(glm::vec3(plane_normal(cofactor)), glm::vec3(0, 0, 1));
  for (Vertex& vertex : out.vertices) {
    vertex.position = glm::vec3(residual * glm::dvec3(vertex.position));
    vertex.normal = unit_or(glm::vec3(cofactor * glm::dvec3(vertex.normal)), plane);
    const glm::vec3 tangent(residual * glm::dvec3(vertex.tangent));
    const glm::vec3 flat = tangent - vertex.normal * glm::dot(vertex.normal, tangent);
    const float sign = vertex.tangent.w * static_cast<float>(side);
    vertex.tangent = glm::vec4(unit_or(flat, perpendicular(vertex.normal)), sign);
  }
  if (determinant < 0) swap_winding(out);
  return out;
}

}  // namespace mirage
