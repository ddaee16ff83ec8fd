#pragma once
// Small natural things: grass, ferns, bushes, flowers, mushrooms, rocks.

#include <cstdint>

#include "server/scene/builtin/scene_parts.h"

namespace mirage::builtin {

struct PlantMaterials {
  std::uint32_t grass = 0;
  std::uint32_t leaves = 0;
  std::uint32_t fern = 0;
  std::uint32_t painted = 0;
  std::uint32_t stone = 0;
};
PlantMaterials add_plant_materials(SceneParts& parts, std::uint32_t seed);

// Each grows one object with its foot at the origin; about 100 to 1,500 triangles.
Mesh grow_grass(const PlantMaterials& materials, std::uint32_t seed, float radius_m, int cards);
Mesh grow_fern(const PlantMaterials& materials, std::uint32_t seed);
Mesh grow_bush(const PlantMaterials& materials, std::uint32_t seed, int cards);
Mesh grow_flower(const PlantMaterials& materials, std::uint32_t seed, glm::vec3 petal);
Mesh grow_mushroom(const PlantMaterials& materials, std::uint32_t seed);
Mesh grow_rock(const PlantMaterials& materials, std::uint32_t seed, int rings);

}  // namespace mirage::builtin
