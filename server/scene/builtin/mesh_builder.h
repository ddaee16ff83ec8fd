#pragma once
// Builds one object's mesh from simple solids. Every solid is wound counter-clockwise from outside,
// and takes the current transform, colour and material.

#include <cstdint>
#include <glm/glm.hpp>
#include <glm/gtc/matrix_transform.hpp>
#include <span>
#include <vector>

#include "protocol/model/model.h"

namespace mirage::builtin {

/// Returns the linear colour of an sRGB one written as 0xRRGGBB.
glm::vec3 rgb(std::uint32_t srgb_hex);

class MeshBuilder {
 public:
  // Set the state for geometry that is added next.
  MeshBuilder& use(std::uint32_t material);
  MeshBuilder& paint(glm::vec3 linear_color);
  MeshBuilder& place(const glm::mat4& object_from_part);
  MeshBuilder& reset() { return place(glm::mat4(1)); }

  // Add raw geometry.
  std::uint32_t vertex(glm::vec3 position, glm::vec3 normal, glm::vec2 uv = glm::vec2(0));
  void triangle(std::uint32_t a, std::uint32_t b, std::uint32_t c);
  void quad(std::uint32_t a, std::uint32_t b, std::uint32_t c, std::uint32_t d);
  /// Adds a flat quad with its own normal; uv (0,0) at a, (1,0) at b, (1,1) at c, scaled by
  /// uv_scale.
  void face(glm::vec3 a, glm::vec3 b, glm::vec3 c, glm::vec3 d, glm::vec2 uv_scale = {1, 1});
  /// Adds a `face` split into nu x nv quads, so that vertex colours can vary over it.
  void grid_face(glm::vec3 a, glm::vec3 b, glm::vec3 d, int nu, int nv,
                 glm::vec2 uv_scale = {1, 1});

  // Add solids.
  void box(glm::vec3 low, glm::vec3 high);
  /// Adds a box with edges rounded by `radius` in `steps` facets.
  void rounded_box(glm::vec3 low, glm::vec3 high, float radius, int steps = 1);
  /// Turns the profile (radius, y) about the y axis. Outside is to the right of its direction: it
  /// starts on the axis at the bottom and ends on it at the top. Kinks over 40 degrees stay sharp.
  void lathe(std::span<const glm::vec2> profile, int segments);
  void cylinder(glm::vec3 base, float radius, float height, int segments);
  void sphere(glm::vec3 center, glm::vec3 radii, int rings, int segments);
  /// Adds a tapered tube along a path; a radius of 0 closes an end. v runs along the length.
  void tube(std::span<const glm::vec3> path, std::span<const float> radii, int sides,
            float v_per_m = 1);
  /// Adds a straight closed rod between two points.
  void rod(glm::vec3 from, glm::vec3 to, float radius, int sides);

  std::uint32_t vertex_count() const { return static_cast<std::uint32_t>(vertices_.size()); }
  std::vector<Vertex>& vertices() { return vertices_; }
  /// Multiplies the colour of every vertex from `first` on by f(position, normal) -> float.
  template <typename F>
  void shade(F f, std::uint32_t first = 0) {
    for (std::size_t i = first; i < vertices_.size(); ++i) {
      Vertex& v = vertices_[i];
      const float k = glm::clamp(static_cast<float>(f(v.position, v.normal)), 0.0f, 1.0f);
      for (int c = 0; c < 3; ++c) {
        v.color[c] = static_cast<std::uint16_t>(static_cast<float>(v.color[c]) * k);
      }
    }
  }

  /// Returns the finished mesh: one primitive per material, without zero-area triangles, with
  /// tangents.
  Mesh take();

 private:
  std::vector<Vertex> vertices_;
  std::vector<std::vector<std::uint32_t>> indices_of_material_;
  std::uint32_t material_ = 0;
  glm::vec3 color_{1};
  glm::mat4 transform_{1};
  glm::mat3 normal_transform_{1};
};

}  // namespace mirage::builtin
