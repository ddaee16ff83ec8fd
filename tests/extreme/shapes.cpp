#include "tests/extreme/shapes.h"

#include <cmath>

namespace mirage::extreme {
namespace {

constexpr double kTau = 6.283185307179586;

glm::dvec3 ball_point(double u, double v) {
  const double theta = 0.5 * kTau * v, phi = kTau * u;
  const double radius = 1 + 0.15 * std::sin(3 * phi) * std::sin(theta) * std::sin(theta) +
                        0.1 * std::cos(5 * theta + 1) * std::sin(theta);
  return radius * glm::dvec3(std::sin(theta) * std::cos(phi), std::cos(theta),
                             std::sin(theta) * std::sin(phi));
}

void put(std::vector<float>& out, const glm::dvec3& v) {
  for (int i = 0; i < 3; ++i) out.push_back(static_cast<float>(v[i]));
}

}  // namespace

Shape dented_ball(int rings, int sectors) {
  Shape out;
  for (int r = 0; r <= rings; ++r) {
    for (int s = 0; s <= sectors; ++s) {
      const double u = static_cast<double>(s) / sectors, v = static_cast<double>(r) / rings;
      const double h = 1e-4, w = std::min(std::max(v, 2 * h), 1 - 2 * h);
      const glm::dvec3 along = ball_point(u + h, w) - ball_point(u - h, w);
      const glm::dvec3 down = ball_point(u, w + h) - ball_point(u, w - h);
      put(out.positions, ball_point(u, v));
      put(out.normals, glm::normalize(glm::cross(along, down)));
    }
  }
  const auto at = [&](int r, int s) { return static_cast<std::uint32_t>(r * (sectors + 1) + s); };
  for (int r = 0; r < rings; ++r) {
    for (int s = 0; s < sectors; ++s) {
      const std::uint32_t a = at(r, s), b = at(r, s + 1), c = at(r + 1, s + 1), d = at(r + 1, s);
      if (r > 0) out.indices.insert(out.indices.end(), {a, b, c});
      if (r + 1 < rings) out.indices.insert(out.indices.end(), {a, c, d});
    }
  }
  return out;
}

Shape box(const glm::dvec3& low, const glm::dvec3& high) {
  Shape out;
  for (int axis = 0; axis < 3; ++axis) {
    for (int side = 0; side < 2; ++side) {
      const auto first = static_cast<std::uint32_t>(out.vertices());
      const int u = (axis + 1) % 3, v = (axis + 2) % 3;
      glm::dvec3 normal(0);
      normal[axis] = side == 1 ? 1 : -1;
      for (const auto& [a, b] : {std::pair{0, 0}, {1, 0}, {1, 1}, {0, 1}}) {
        glm::dvec3 p;
        p[axis] = side == 1 ? high[axis] : low[axis];
        p[u] = (side == 1 ? a : b) ? high[u] : low[u];
        p[v] = (side == 1 ? b : a) ? high[v] : low[v];
        put(out.positions, p);
        put(out.normals, normal);
      }
      for (const std::uint32_t i : {0u, 1u, 2u, 0u, 2u, 3u}) out.indices.push_back(first + i);
    }
  }
  return out;
}

Shape joined(const Shape& a, const Shape& b) {
  Shape out = a;
  out.positions.insert(out.positions.end(), b.positions.begin(), b.positions.end());
  out.normals.insert(out.normals.end(), b.normals.begin(), b.normals.end());
  const auto first = static_cast<std::uint32_t>(a.vertices());
  for (const std::uint32_t i : b.indices) out.indices.push_back(first + i);
  return out;
}

Shape scaled(Shape shape, double scale) {
  for (float& p : shape.positions) p = static_cast<float>(p * scale);
  return shape;
}

test::Builder document(const Shape& shape) {
  test::Builder builder;
  nlohmann::json attributes = {{"POSITION", builder.vec3(shape.positions)}};
  if (!shape.normals.empty()) attributes["NORMAL"] = builder.vec3(shape.normals);
  builder.mesh(attributes, builder.accessor(shape.indices, "SCALAR", 5125, 1));
  return builder;
}

void set_material(test::Builder& builder, const nlohmann::json& material) {
  builder.doc["materials"].push_back(material);
  builder.primitive()["material"] = builder.doc["materials"].size() - 1;
}

std::string write(const test::Builder& builder, const std::string& folder,
                  const std::string& name) {
  const std::string path = folder + "/" + name + ".glb", bytes = builder.glb();
  std::ofstream(path, std::ios::binary)
      .write(bytes.data(), static_cast<std::streamsize>(bytes.size()));
  return path;
}

}  // namespace mirage::extreme
