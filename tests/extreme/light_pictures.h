#pragma once
// Light pictures: a ball under a given light, drawn in every way.

#include <memory>
#include <vector>

#include "tests/extreme/studio.h"

namespace mirage::extreme {

constexpr int kLightPictureEdge = 96;  ///< px

/// Returns a dented ball under a black sky, so that all light is the object's. Its alpha, which
/// only the mode "BLEND" uses, is 0.6.
Result<std::unique_ptr<Studio>> ball_studio(const Conditions& conditions, float metallic = 0.3f,
                                            const char* alpha_mode = "OPAQUE");

Light point_light(const glm::dvec3& position, float intensity);
Light sun(float intensity, const glm::vec3& towards = {-0.4f, -0.7f, -0.6f});
Light spot(float intensity);
Lighting only(float ambient, std::vector<Light> lights);

/// Pictures from (0.5, 0.4, 1), at a distance of 4 radii; tiles are drawn as relief.
struct Shots {
  Pixels truth, mesh, lit, relit;
};
Shots shoot(Studio& studio, const Lighting& light);

/// Returns the largest colour component where alpha is 255.
int brightest(const Pixels& p);
/// Returns the components that are darker in `b` than in `a` by more than `by`, where both are
/// solid.
int darker(const Pixels& a, const Pixels& b, int by);

}  // namespace mirage::extreme
