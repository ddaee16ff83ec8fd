#pragma once
// Shapes: meshes for the cases, as glTF documents that go through the importer.

#include <cmath>
#include <glm/glm.hpp>
#include <random>

#include "tests/support/gltf_builder.h"

namespace mirage::extreme {

/// Positions and indices of triangles, before they are a document.
struct Shape {
  std::vector<float> positions, normals;  ///< normals may be empty: the importer makes them
  std::vector<std::uint32_t> indices;

  std::size_t vertices() const { return positions.size() / 3; }
};

/// Returns a dented ball without any symmetry, radius about 1, with smooth normals: 2 * rings *
/// sectors triangles.
Shape dented_ball(int rings = 24, int sectors = 32);
/// An axis-aligned box.
Shape box(const glm::dvec3& low, const glm::dvec3& high);
/// Returns both shapes, one after the other.
Shape joined(const Shape& a, const Shape& b);
/// Returns the shape at `scale` times its size.
Shape scaled(Shape shape, double scale);

/// Returns a document with one mesh of one primitive drawn by one node; it may be edited further.
test::Builder document(const Shape& shape);
/// Adds a material (glTF JSON) and gives it to the first primitive.
void set_material(test::Builder& builder, const nlohmann::json& material);
/// Writes the document into `folder`. Returns its path.
std::string write(const test::Builder& builder, const std::string& folder, const std::string& name);

/// Uniform numbers from a seed.
class Random {
 public:
  explicit Random(std::uint64_t seed) : engine_(seed) {}
  double uniform(double low, double high) {
    return low + (high - low) * std::uniform_real_distribution<double>(0, 1)(engine_);
  }
  double log_uniform(double low, double high) { return low * std::pow(high / low, uniform(0, 1)); }
  glm::dvec3 direction() {
    while (true) {
      const glm::dvec3 v(uniform(-1, 1), uniform(-1, 1), uniform(-1, 1));
      if (glm::length(v) > 1e-3 && glm::length(v) < 1) return glm::normalize(v);
    }
  }

 private:
  std::mt19937_64 engine_;
};

}  // namespace mirage::extreme
