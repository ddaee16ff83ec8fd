#pragma once
// Insight: shows over the picture how it was made. Each pixel gets a tint that tells what it is
// drawn from.
// Input:  the draw list of a frame, and a layer to show.
// Output: tints over the picture in the window's framebuffer (0).
// Thread: the GL thread.
// Full:   never; it keeps nothing between frames but a target of the picture's size.

#include <array>
#include <cstdint>
#include <memory>

#include "protocol/base/result.h"

namespace mirage {

struct Camera;
struct DrawList;
class FrameRenderer;
struct PlannedFrame;
struct Tints;

enum class InsightLayer : std::uint8_t {
  kNone,
  kSources,   ///< blue flat tile, green tile with depth, yellow geometry, red no image
  kBound,     ///< bound over tau: green 0, yellow 1, red 2 and more
  kAge,       ///< age of tiles: green new, red a minute and older
  kGeometry,  ///< what is drawn from geometry
};
inline constexpr std::size_t kInsightLayers = 4;

class Insight {
 public:
  Insight();
  Insight(Insight&& other) noexcept;
  Insight& operator=(Insight&& other) noexcept;
  ~Insight();
  /// Creates the program. Error kGraphicsShader.
  static Result<Insight> create();
  /// Draws over the picture of the frame. `camera` is the frame's, at the size of the framebuffer.
  /// Errors kGraphicsShader, kGraphicsGl (no memory for a picture of tints).
  Result<void> draw(InsightLayer layer, FrameRenderer& renderer, const Camera& camera,
                    const PlannedFrame& frame, std::int64_t now_us);

 private:
  struct Parts;
  std::unique_ptr<Parts> parts_;
};

/// Returns the tints of a layer other than kNone.
Tints tints_of(InsightLayer layer, const DrawList& list, double tau_px, std::int64_t now_us);

/// Returns the RGB colour for a share of what is tolerated: green 0, yellow 1/2, red 1 and more.
std::array<float, 3> heat(double share);

}  // namespace mirage
