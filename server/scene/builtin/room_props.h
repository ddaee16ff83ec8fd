#pragma once
// Furniture and small things of the room. Every prop stands on y = 0, its front to +z.

#include <cstdint>

#include "server/scene/builtin/scene_parts.h"

namespace mirage::builtin {

struct RoomMaterials {
  std::uint32_t matte = 0;   ///< colour from vertices
  std::uint32_t glossy = 0;  ///< glazed, lacquered
  std::uint32_t metal = 0;
  std::uint32_t wood = 0;    ///< planks texture
  std::uint32_t screen = 0;  ///< image on a monitor, as if it shone
  std::uint32_t picture = 0;
  std::uint32_t glow = 0;  ///< lamp shades
};
RoomMaterials add_room_materials(SceneParts& parts, std::uint32_t seed);

inline constexpr float kDeskHeight = 0.74f;
inline constexpr int kShelfBoards = 5;
/// Returns the height of the top of a shelf's board, counted from the lowest.
float shelf_board_height(int board);

// Furniture.
Mesh make_desk(const RoomMaterials& m);
Mesh make_chair(const RoomMaterials& m, glm::vec3 color);
Mesh make_shelf(const RoomMaterials& m);
Mesh make_sofa(const RoomMaterials& m);
Mesh make_floor_lamp(const RoomMaterials& m);
Mesh make_pendant(const RoomMaterials& m);  ///< hangs down from y = 0

// Small things.
Mesh make_book(const RoomMaterials& m, std::uint32_t seed);
Mesh make_book_row(const RoomMaterials& m, std::uint32_t seed);
Mesh make_mug(const RoomMaterials& m, glm::vec3 color);
Mesh make_desk_lamp(const RoomMaterials& m);
Mesh make_pot_plant(const RoomMaterials& m, std::uint32_t seed);
Mesh make_ball(const RoomMaterials& m, glm::vec3 a, glm::vec3 b);
Mesh make_carton(const RoomMaterials& m);
Mesh make_vase(const RoomMaterials& m, glm::vec3 color);
Mesh make_monitor(const RoomMaterials& m);
Mesh make_keyboard(const RoomMaterials& m);
Mesh make_picture_frame(const RoomMaterials& m);  ///< back on z = 0
Mesh make_bottle(const RoomMaterials& m, glm::vec3 color);
Mesh make_bowl(const RoomMaterials& m, std::uint32_t seed);
Mesh make_globe(const RoomMaterials& m, std::uint32_t seed);

}  // namespace mirage::builtin
