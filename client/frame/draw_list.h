#pragma once
// What is decided to be drawn in a frame: handed from planning to drawing.

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
  double distance = 0;  ///< eye to centre, m
  float fade = 1;       ///< opacity while fading in
  /// For how long the light it shows has been past; 0: shown right, or within tau of it.
  std::int64_t light_lag_us = 0;
  /// What the sun's shadows take away; null: drawn without.
  ShadowRecordPtr shadow{};
};

/// An instance that has no tile yet: its part of the view tile, or its proxy in its mean colour.
struct DrawnPlaceholder {
  std::uint32_t instance = 0;
  double distance = 0;
  bool covered = false;  ///< the view tile shows what is there instead
};

/// What of the view tile is drawn.
struct DrawnView {
  std::shared_ptr<const ViewTile> tile;
  std::vector<bool> owners;  ///< by index into ViewTile::instances
  /// Whether the instance with this id of the server's is.
  bool shows(std::uint32_t id) const;
};

struct DrawList {
  std::vector<DrawnImpostor> impostors;  ///< back to front (blend_order.h)
  std::vector<DrawnPlaceholder> placeholders;
  std::optional<DrawnView> view;  ///< of placeholders, and before there is a scene
  std::vector<DrawnMesh> meshes;
  std::size_t visible = 0;  ///< instances and groups in view, large enough to matter
  /// Of them, drawn with a bound above what is allowed, or from no tile. Allowed is tau, scaled by
  /// the importance the scene gives.
  std::size_t over_tau = 0;
  double time_s = 0;      ///< of the animation
  CasterListPtr casters;  ///< of the shadows on geometry; null: there are none

  /// That are drawn, those beneath a fade among them.
  std::vector<TileRecordPtr> tiles() const {
    std::vector<TileRecordPtr> out;
    for (const DrawnImpostor& drawn : impostors) out.push_back(drawn.tile);
    return out;
  }
};

}  // namespace mirage
