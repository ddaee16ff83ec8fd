#pragma once
// Selector.
// Input:  scene, resident tiles, the true and the predicted camera. Output: what to draw now, and
//         what to ask for, by the error bound.
// Thread: the frame loop's. Never full: one decision per visible instance and frame.

#include <array>
#include <cstdint>
#include <vector>

#include "client/core/tile_cache.h"

namespace mirage {

/// How impostors are drawn: one method, or the cheapest that meets tau.
struct MethodChoice {
  bool automatic = true;
  DrawMethod method = DrawMethod::kQuad;
};

/// An instance drawn from a tile.
struct DrawnImpostor {
  std::uint32_t instance = 0;
  TileRecordPtr tile;
  DrawMethod method = DrawMethod::kQuad;
  double bound_px = 0;
  double distance = 0;  ///< eye to centre, m
  float fade = 1;       ///< opacity while fading in
  /// Further tiles of the object that help where `tile` has nothing (kDepth only), from the front.
  std::array<TileRecordPtr, 2> neighbours{};
};

/// An instance that has no tile yet: its proxy in its mean colour.
struct DrawnPlaceholder {
  std::uint32_t instance = 0;
  double distance = 0;
};

struct DrawList {
  std::vector<DrawnImpostor> impostors;
  std::vector<DrawnPlaceholder> placeholders;
  std::vector<std::uint32_t> meshes;  ///< instances drawn as geometry
  std::size_t visible = 0;            ///< instances in view and large enough to matter
  std::size_t over_tau = 0;           ///< of them, drawn with a bound above tau or from no tile
};

/// A tile worth asking for.
struct TileNeed {
  std::uint32_t instance = 0;
  ViewCell cell;
  DistanceBucket distance;
  std::uint8_t size_class = 0;
  double error_px = 0;  ///< what showing the present state costs
  double gain = 0;      ///< error_px times the seconds the new tile is expected to serve: the rank
};

struct SelectorInput {
  const SceneView* scene = nullptr;
  const TileCache* cache = nullptr;
  const std::vector<bool>* mesh_ready = nullptr;  ///< per object
  Camera camera;
  Camera predicted;
  double speed_mps = 0;  ///< of the eye
  double tau_px = 1;
  MethodChoice method;
  double march_budget_px = 1e9;  ///< screen area that may be drawn by marching depth
  double mesh_radii = 2;         ///< nearer than this many radii, geometry is drawn if it is there
  std::uint64_t frame = 0;
  std::int64_t now_us = 0;
};

class Selector {
 public:
  /// Forgets which tile each instance showed.
  void reset(const SceneView& scene);

  /// Decides what is drawn this frame; marks the tiles as drawn.
  DrawList select(const SelectorInput& input);
  /// What to ask for, largest gain first; instances without any acceptable tile at the predicted
  /// view.
  std::vector<TileNeed> needs(const SelectorInput& input) const;
  /// Objects that should come as geometry: too near for any impostor, now or soon.
  std::vector<std::uint32_t> mesh_needs(const SelectorInput& input) const;

 private:
  struct Shown {
    TileRecordPtr tile;
    TileRecordPtr former;  ///< still drawn underneath while `tile` fades in
    std::int64_t since_us = 0;
  };
  /// An instance that has tiles, before it is settled how it is drawn.
  struct Candidate;
  void consider(const SelectorInput& in, std::uint32_t instance, DrawList& out,
                std::vector<Candidate>& candidates);
  void draw_candidate(const SelectorInput& in, const Candidate& candidate, DrawList& out);
  std::vector<Shown> shown_;
};

/// The instance's view in object units, relative to its centre.
ViewGeometry view_geometry(const Camera& camera, const InstanceView& instance,
                           const ObjectDescription& object);
/// The key whose capture at `view` keeps a quad within a quarter of tau all over its cell, at 1.5
/// texels per pixel.
TileNeed need_for_view(const ViewGeometry& view, double tau_px);
/// Projected radius of the bounding sphere in px.
double radius_px(const ViewGeometry& view);

}  // namespace mirage
