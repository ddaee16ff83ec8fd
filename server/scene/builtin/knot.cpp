// The torus knot of many three.js demos (TorusKnotGeometry with its defaults), vertex for vertex,
// so that the two can be compared.

#include <cmath>

#include "server/scene/builtin/scene_parts.h"

namespace mirage::builtin {
namespace {

constexpr double kTwoPi = 6.283185307179586;

glm::dvec3 curve_point(double u, double p, double q, double radius) {
  const double cu = std::cos(u);
  const double su = std::sin(u);
  const double over = q / p * u;
  const double cs = std::cos(over);
  return {radius * (2 + cs) * 0.5 * cu, radius * (2 + cs) * su * 0.5,
          radius * std::sin(over) * 0.5};
}

}  // namespace

Scene build_knot(const OptionValues& options) {
  const double radius = options[0];
  const double tube = options[1];
  const auto tubular = static_cast<std::uint32_t>(options[2]);
  const auto radial = static_cast<std::uint32_t>(options[3]);
  const double p = options[4];
  const double q = options[5];
  SceneParts parts;
  Material material = painted_material(1);
  material.base_color = {0.8f, 0.35f, 0.2f, 1};
  MeshBuilder builder;
  builder.use(parts.add(material));
  for (std::uint32_t i = 0; i <= tubular; ++i) {
    const double u = static_cast<double>(i) / tubular * p * kTwoPi;
    const glm::dvec3 p1 = curve_point(u, p, q, radius);
    const glm::dvec3 p2 = curve_point(u + 0.01, p, q, radius);
    const glm::dvec3 t = p2 - p1;
    const glm::dvec3 b = glm::cross(t, p2 + p1);
    const glm::dvec3 n = glm::normalize(glm::cross(b, t));
    const glm::dvec3 b1 = glm::normalize(b);
    for (std::uint32_t j = 0; j <= radial; ++j) {
      const double v = static_cast<double>(j) / radial * kTwoPi;
      const glm::dvec3 out = n * -std::cos(v) + b1 * std::sin(v);
      builder.vertex(glm::vec3(p1 + out * tube), glm::vec3(out),
                     {static_cast<double>(i) / tubular, static_cast<double>(j) / radial});
    }
  }
  for (std::uint32_t i = 1; i <= tubular; ++i) {
    for (std::uint32_t j = 1; j <= radial; ++j) {
      const std::uint32_t a = (radial + 1) * (i - 1) + j - 1;
      const std::uint32_t c = (radial + 1) * i + j;
      builder.triangle(a, c - 1, a + 1);
      builder.triangle(c - 1, c, a + 1);
    }
  }
  parts.put(parts.add("torus knot", builder.take()), {0, 0, 0});
  parts.scene.lighting.ambient = glm::vec3(0.6f);
  parts.scene.lighting.lights = {sun_light({2, 3, 1}, glm::vec3(0.8f))};
  parts.scene.environment = {glm::vec3(0.216f), glm::vec3(0.216f), glm::vec3(0.216f)};
  // The eye looks at the knot from 4 radii; the loop starts there and swings away behind.
  const double size = 1.5 * radius + tube;
  HomeView& home = parts.scene.home;
  home.eye = {0, 0, 4 * size};
  home.target = {0, 0, 0};
  // Home views begin nearer: a circle around the knot fills the picture.
  for (int i = 0; i < 8; ++i) {
    home.fit.emplace_back(size * std::cos(i * kTwoPi / 8), size * std::sin(i * kTwoPi / 8), 0);
  }
  home.walk_radius_m = 1.4 * size;
  home.walk_speed_mps = 0.5;
  return std::move(parts.scene);
}

}  // namespace mirage::builtin
