#pragma once
// Sun place: where a directional light stands in the sky.

#include <optional>

namespace mirage {

struct Lighting;

/// A place in the sky, degrees: azimuth from -z, the eye's usual direction, to the right, and
/// elevation above the horizon.
struct SunPlace {
  double azimuth = 0, elevation = 0;
};

/// Returns where the first directional light stands; nullopt: there is none.
std::optional<SunPlace> sun_place(const Lighting& lighting);
/// Puts all directional lights there; their strengths stay.
void put_sun(const SunPlace& at, Lighting& lighting);

}  // namespace mirage
