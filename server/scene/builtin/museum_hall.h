#pragma once
// The hall of the museum: floor, wall, dome, pillars, pictures, plinths, all with few triangles.

#include <vector>

#include "server/scene/builtin/scene_parts.h"

namespace mirage::builtin {

struct Hall {
  float radius = 18;
  float wall_height = 6.5f;
  float loop_radius = 8;           ///< radius of the walk, marked by a carpet
  std::vector<glm::vec3> shadows;  ///< x, z, radius: darkens the floor around things
};

struct Plinth {
  std::uint32_t object = 0;
  float height = 0;
};
/// Plinths, low for tall sculptures and high for small ones, square and round.
class Plinths {
 public:
  explicit Plinths(SceneParts& parts, std::uint32_t seed);
  const Plinth& under(float sculpture_height, bool round) const;

 private:
  std::vector<Plinth> square_, round_;
};

inline constexpr float kPlinthRadius = 0.8f;  ///< largest distance of a corner from the axis

/// Adds the shell of the hall with its pictures, and pillars along its wall.
void add_hall(SceneParts& parts, const Hall& hall, std::uint32_t seed);

}  // namespace mirage::builtin
