#include "server/prepare/object_description.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "protocol/base/limits.h"
#include "server/prepare/convex_hull.h"
#include "server/prepare/motion_measure.h"

namespace mirage {
namespace {

// Returns the mean linear colour of what can be seen of an image, and its mean alpha.
glm::vec4 mean_image_color(const Image& image) {
  glm::dvec3 sum(0);
  double weight = 0;
  const std::size_t pixels = image.rgba.size() / 4;
  const std::size_t step = std::max<std::size_t>(1, pixels / 4096);
  for (std::size_t i = 0; i < pixels; i += step) {
    const std::uint8_t* p = &image.rgba[i * 4];
    const double a = p[3] / 255.0;
    for (int c = 0; c < 3; ++c) sum[c] += a * std::pow(p[c] / 255.0, image.srgb ? 2.2 : 1.0);
    weight += a;
  }
  const std::size_t looked_at = (pixels + step - 1) / step;
  return weight > 0 ? glm::vec4(sum / weight, weight / static_cast<double>(looked_at))
                    : glm::vec4(0.5f, 0.5f, 0.5f, 0);
}

// Returns the cone of a mesh at rest, a little wider than its normals.
FacingCone facing_cone(const Mesh& mesh, const std::vector<Material>& materials) {
  constexpr double kMargin = 1e-3;
  const bool one_sided =
      std::all_of(mesh.primitives.begin(), mesh.primitives.end(), [&](const Primitive& p) {
        return p.kind == PrimitiveKind::kTriangles && !materials[p.material].double_sided;
      });
  if (!one_sided) return {};
  std::vector<glm::dvec3> normals;
  glm::dvec3 sum(0);
  for (std::size_t i = 0; i + 2 < mesh.indices.size(); i += 3) {
    const glm::dvec3 a(mesh.vertices[mesh.indices[i]].position);
    const glm::dvec3 b(mesh.vertices[mesh.indices[i + 1]].position);
    const glm::dvec3 c(mesh.vertices[mesh.indices[i + 2]].position);
    const glm::dvec3 across = glm::cross(b - a, c - a);
    const double length = glm::length(across);
    if (!(length > 0)) continue;
    normals.push_back(across / length);
    sum += normals.back();
  }
  if (!(glm::length(sum) > 0.1 * static_cast<double>(normals.size()))) return {};
  const glm::dvec3 axis = glm::normalize(sum);
  double least = 1;
  for (const glm::dvec3& n : normals) least = std::min(least, glm::dot(n, axis));
  if (!(least > 0)) return {};
  const double sine = std::sqrt(1 - std::min(1.0, least * least)) + kMargin;
  return sine < 1 ? FacingCone{glm::vec3(axis), static_cast<float>(sine)} : FacingCone{};
}

/// Cuts a text in UTF-8 so that it fits, between two characters.
std::string shortened(const std::string& text) {
  if (text.size() <= limits::kMaxObjectNameBytes) return text;
  std::size_t end = limits::kMaxObjectNameBytes;
  while (end > 0 && (static_cast<unsigned char>(text[end]) & 0xC0U) == 0x80U) --end;
  return text.substr(0, end);
}

}  // namespace

std::map<std::uint32_t, glm::vec4> material_colors(const Mesh& mesh, const Scene& scene) {
  std::map<std::uint32_t, glm::vec4> out;
  for (const Primitive& p : mesh.primitives) {
    const Material& m = scene.materials[p.material];
    const auto [at, is_new] = out.emplace(p.material, m.base_color + glm::vec4(m.emissive, 0));
    if (!is_new) continue;
    if (m.base_color_map.present()) {
      at->second *=
          mean_image_color(scene.images[static_cast<std::size_t>(m.base_color_map.image)]);
    }
  }
  return out;
}

glm::vec4 mean_color(const Mesh& mesh, const std::map<std::uint32_t, glm::vec4>& of_material,
                     const std::vector<Material>& materials) {
  glm::dvec4 sum(0);  // colours times what is opaque of their area
  double area_sum = 0;
  for (const Primitive& p : mesh.primitives) {
    if (p.kind != PrimitiveKind::kTriangles) continue;
    const glm::vec4 base = of_material.at(p.material);
    const bool blends = materials[p.material].alpha_mode == AlphaMode::kBlend;
    const std::uint32_t step = 3 * std::max(1u, p.index_count / 3 / 2000);
    for (std::uint32_t i = 0; i + 2 < p.index_count; i += step) {
      const std::uint32_t* at = &mesh.indices[p.first_index + i];
      const Vertex& a = mesh.vertices[at[0]];
      const Vertex& b = mesh.vertices[at[1]];
      const Vertex& c = mesh.vertices[at[2]];
      const double area =
          step * double{glm::length(glm::cross(b.position - a.position, c.position - a.position))};
      const glm::dvec4 color = glm::dvec4(base * glm::vec4(a.color) / 65535.0f);
      const double solid = blends ? color.a : 1;
      sum += glm::dvec4(glm::dvec3(color), 1) * (solid * area);
      area_sum += area;
    }
  }
  if (!(area_sum > 0) || !std::isfinite(area_sum)) return {0.5f, 0.5f, 0.5f, 1};
  if (!(sum.a > 0)) return {0.5f, 0.5f, 0.5f, 0};
  return glm::clamp(glm::vec4(glm::dvec3(sum) / sum.a, sum.a / area_sum), 0.0f, 1.0f);
}

ObjectDescription describe_object(const SceneObject& object, const Scene& scene,
                                  const Workers& workers) {
  ObjectDescription out;
  out.name = shortened(object.name);
  std::vector<glm::vec3> points;
  points.reserve(object.mesh.indices.size() / 2);
  std::vector<bool> used(object.mesh.vertices.size(), false);
  for (const std::uint32_t i : object.mesh.indices) {
    if (!used[i]) points.push_back(object.mesh.vertices[i].position);
    used[i] = true;
  }
  for (const Primitive& p : object.mesh.primitives) {
    if (p.kind == PrimitiveKind::kTriangles) out.triangles += p.index_count / 3;
  }
  out.needs = object_needs(object.mesh, scene.materials);
  if (points.empty()) return out;
  out.box_min = out.box_max = points[0];
  for (const glm::vec3& p : points) {
    out.box_min = glm::min(out.box_min, p);
    out.box_max = glm::max(out.box_max, p);
  }
  out.center = 0.5f * (out.box_min + out.box_max);
  double radius = 0;
  for (const glm::vec3& p : points) {
    radius = std::max(radius, glm::length(glm::dvec3(p) - glm::dvec3(out.center)));
  }
  // The radius is rounded up, so that every vertex is inside in float arithmetic too; a single
  // point gets some extent.
  const double floor_radius = 1e-6 * std::max(1.0, glm::length(glm::dvec3(out.center)));
  out.radius = static_cast<float>(std::max(radius * 1.00001, std::min(floor_radius, 1e-3)));
  if (Result<ConvexHull> hull = enclosing_hull(points); hull.ok()) out.hull = hull.take();
  out.hull.parallax = parallax_factors(out.hull, points, out.center, workers);
  const glm::vec4 mean =
      mean_color(object.mesh, material_colors(object.mesh, scene), scene.materials);
  out.mean_color = glm::vec3(mean);
  out.opacity = mean.a;
  if (!object.animation && !object.track.moves())
    out.faces = facing_cone(object.mesh, scene.materials);
  return out;
}

void use_motion(const MeasuredMotion& measured, ObjectDescription& out) {
  out.motion = measured.motion;
  out.box_min = measured.box_min;
  out.box_max = measured.box_max;
  out.center = measured.center;
  out.radius = static_cast<float>(measured.radius * 1.00001);
  if (Result<ConvexHull> hull = enclosing_hull(measured.hull_points); hull.ok()) {
    out.hull = hull.take();
  }
}

ImageDescription describe_image(const Scene& scene, std::size_t index) {
  const Image& image = scene.images[index];
  ImageDescription out{image.width, image.height, image.srgb, {}, 0};
  std::array<std::uint64_t, 3> sum{};
  std::uint64_t alpha = 0;
  const std::size_t pixels = image.rgba.size() / 4;
  for (std::size_t i = 0; i < pixels; ++i) {
    const std::uint8_t* p = &image.rgba[i * 4];
    for (std::size_t c = 0; c < 3; ++c) sum[c] += std::uint32_t{p[3]} * p[c];
    alpha += p[3];
  }
  for (std::size_t c = 0; c < 3; ++c) {
    out.mean[c] = static_cast<std::uint8_t>(alpha > 0 ? sum[c] / alpha : 128);
  }
  out.mean[3] = static_cast<std::uint8_t>(alpha / pixels);
  out.alpha_cutoff = alpha_test_cutoff(static_cast<std::int32_t>(index), scene.materials);
  return out;
}

}  // namespace mirage
