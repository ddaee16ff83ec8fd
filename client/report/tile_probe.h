#pragma once
// Tile probe: tiles for exactly one view, asked for by key over the wire. Fidelity is measured on
// them.
// Input:  a server's address, a camera to capture from.
// Output: the tiles, as a draw list.
// Thread: the GL thread.
// Full:   never; each capture replaces the one before.

#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "client/draw/frame_renderer.h"
#include "client/frame/draw_list.h"
#include "client/hold/tile_cache.h"
#include "client/native/native_link.h"
#include "client/plan/tile_need.h"
#include "client/scene/scene_view.h"

namespace mirage {

class TileProbe {
 public:
  /// Connects, learns the scene, and sets its light. `renderer` takes the tiles, and must outlive
  /// the probe. Errors kUsage, kNetwork….
  static Result<std::unique_ptr<TileProbe>> open(const std::string& url, const Lighting& lighting,
                                                 FrameRenderer& renderer);

  const SceneView& scene() const { return scene_; }
  const Lighting& lighting() const { return lighting_; }

  /// Captures a tile of every instance from `captured.pose.eye` for a picture of that camera.
  /// Returns a list that draws them with `method`, back to front for `camera`. Instances whose
  /// sphere the eye is within limits::kMinCaptureRadii of are left out. The former capture is gone.
  /// Errors kNetworkTimeout, and those of the decoders.
  Result<DrawList> capture(const Camera& captured, const Camera& camera, DrawMethod method);
  /// Captures tiles from the nearest of eight views around the horizon (eight_views.h), drawn flat.
  Result<DrawList> eight_views(const Camera& camera);
  /// Returns the graphics memory of the last captured tiles: colour and depth.
  std::size_t texture_bytes() const { return cache_.atlas_texels() * 5; }

  std::function<void(const Tile&)> on_tile;  ///< called with each arriving tile; may be empty

 private:
  TileProbe(const ServerUrl& url, FrameRenderer& renderer);
  Result<void> meet();
  Result<void> send_asks(const std::vector<TileNeed>& needs);
  Result<void> take(const Message& message, const std::vector<TileNeed>& needs);
  Result<DrawList> draw_list(const std::vector<TileNeed>& needs, const Camera& camera,
                             DrawMethod method);

  NativeLink link_;
  FrameRenderer& renderer_;
  SceneView scene_;
  Lighting lighting_;
  TileCache cache_;
  std::vector<TileRecordPtr> records_;  ///< tiles in the order of the asks
  std::uint32_t first_request_ = 1;
  std::size_t answered_ = 0;
  std::uint64_t received_bytes_ = 0;
};

}  // namespace mirage
