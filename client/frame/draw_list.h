#pragma once
// Draw list: everything that planning decided to draw in a frame, handed to drawing.

#include <cstdint>
#include <memory>
#include <optional>
#include <vector>

#include "client/frame/caster_list.h"
#include "client/frame/drawn_mesh.h"
#include "client/frame/resident.h"

namespace mirage {

struct ViewTile;

/// An instance drawn from a tile.
struct DrawnImpostor {
  std::uint32_t instance = 0;
  TileRecordPtr tile;
  DrawMethod method = DrawMethod::kQuad;
  double bound_px = 0;
  double distance = 0;  ///< from the eye to the centre, m
  float fade = 1;       ///< opacity (0..1) while it fades in
  /// Time since the light that the tile shows has ended, us; 0 if the tile shows the present light,
  /// or one within tau of it.
  std::int64_t light_lag_us = 0;
  /// Tile of the shadows that the sun casts on the instance; null: drawn without shadows.
  ShadowRecordPtr shadow{};
};

/// An instance that has no tile yet: its part of the view tile, or its proxy in its mean colour.
struct DrawnPlaceholder {
  std::uint32_t instance = 0;
  double distance = 0;
  bool covered = false;  ///< true if the view tile shows its place instead
};

/// The part of the view tile that is drawn in a frame.
struct DrawnView {
  std::shared_ptr<const ViewTile> tile;
  std::vector<bool> owners;  ///< which instances are drawn; by index into ViewTile::instances
  /// True if the instance with the server's id `id` is drawn from the view tile.
  bool shows(std::uint32_t id) const;
};

struct DrawList {
  std::vector<DrawnImpostor> impostors;  ///< back to front (blend_order.h)
  std::vector<DrawnPlaceholder> placeholders;
  /// View tile that stands for placeholders, and for everything before there is a scene.
  std::optional<DrawnView> view;
  std::vector<DrawnMesh> meshes;
  std::size_t visible = 0;  ///< instances and groups in view that are large enough to matter
  /// Visible ones that are drawn with a bound above the tolerated one, or from no tile. The
  /// tolerated bound is tau, scaled by the importance that the scene gives.
  std::size_t over_tau = 0;
  double time_s = 0;      ///< time of the animation, s
  CasterListPtr casters;  ///< casters of shadows on geometry; null: there are none

  /// Returns the tiles drawn this frame, including those beneath a tile that fades in.
  std::vector<TileRecordPtr> tiles() const {
    std::vector<TileRecordPtr> out;
    for (const DrawnImpostor& drawn : impostors) out.push_back(drawn.tile);
    return out;
  }
};

}  // namespace mirage
