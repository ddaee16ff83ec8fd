#pragma once
// Buildings on a footprint of kLot x kLot metres, and street furniture; the ground is y = 0.

#include <cstdint>

#include "server/scene/builtin/scene_parts.h"

namespace mirage::builtin {

struct CityMaterials {
  std::uint32_t wall = 0;   ///< plaster texture times vertex colour
  std::uint32_t glass = 0;  ///< smooth, colour from vertices
  std::uint32_t matte = 0;
  std::uint32_t metal = 0;
  std::uint32_t paint = 0;  ///< car paint
  std::uint32_t leaves = 0;
};
CityMaterials add_city_materials(SceneParts& parts, std::uint32_t seed);

inline constexpr float kLot = 16;
inline constexpr int kBuildingKinds = 9;
/// Makes a building of about 1,500 to 6,000 triangles.
Mesh make_building(const CityMaterials& m, int kind, std::uint32_t seed);
const char* building_name(int kind);

Mesh make_street_lamp(const CityMaterials& m);  ///< its arm points to +z
Mesh make_street_tree(const CityMaterials& m, std::uint32_t seed);
Mesh make_car(const CityMaterials& m, glm::vec3 color, bool van);  ///< 4.3 m along z
Mesh make_bench(const CityMaterials& m);
Mesh make_bin(const CityMaterials& m);

}  // namespace mirage::builtin
