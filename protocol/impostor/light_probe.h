#pragma once
// Light probe: the light that reaches a place from all around, prefiltered once. Diffuse light is
// held as order-2 spherical harmonics, reflections as octahedral maps of growing roughness in one
// small texture. All shading at both ends reads the same numbers.

#include <array>
#include <cstddef>
#include <cstdint>
#include <glm/glm.hpp>
#include <vector>

namespace mirage {

inline constexpr std::size_t kProbeTerms = 9;  ///< spherical harmonics to order 2

/// Place of one map of reflections: a square at (x, y) of the texture. Its margin of one texel
/// repeats the texels across the octahedron's fold, so linear filtering works.
struct ProbeLevel {
  int x, y, edge;  ///< texels
};
/// Places of all maps; lighting.glsl has the same table. Roughness grows by 10^(1/5) a level, from
/// 0.1 to 1. The lobe (width about roughness^2) thus grows by 2.5, and is never much narrower than
/// a texel.
inline constexpr std::array<ProbeLevel, 6> kProbeLevels = {
    {{0, 0, 256}, {256, 0, 128}, {256, 128, 64}, {320, 128, 32}, {352, 128, 32}, {320, 160, 32}}};
inline constexpr int kProbeWidth = 384, kProbeHeight = 256;
inline constexpr std::size_t kProbeTexels = std::size_t{kProbeWidth} * kProbeHeight;

/// Returns the perceptual roughness (glTF's) of a level.
double probe_roughness(std::size_t level);

struct LightProbe {
  std::uint64_t id = 0;  ///< hash of the other members; never 0
  /// Irradiance over pi: coefficients of 1, y, z, x, xy, yz, 3z^2 - 1, xz, x^2 - y^2 (Ramamoorthi
  /// and Hanrahan 2001).
  std::array<glm::vec3, kProbeTerms> irradiance{};
  std::vector<std::uint32_t> texels;  ///< kProbeTexels of shared-exponent radiance, rows from v = 0
};

/// Returns irradiance over pi on a surface with this unit normal, at least 0.
glm::vec3 irradiance_over_pi(const LightProbe& probe, const glm::vec3& normal);

/// Returns the direction of a point inside a level, for u and v in 0..1, and across the fold
/// beyond. The octahedron's tip is +y, its folds run to -y.
glm::dvec3 probe_direction(double u, double v);

/// Packs linear radiance into GL_RGB9_E5, 0 to 65408 a channel: 9 bits each and one shared exponent
/// (EXT_texture_shared_exponent).
std::uint32_t pack_shared_exponent(const glm::vec3& radiance);
glm::vec3 unpack_shared_exponent(std::uint32_t texel);

/// Returns a hash of irradiance and texels, never 0.
std::uint64_t probe_id(const LightProbe& probe);

}  // namespace mirage
