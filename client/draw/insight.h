#pragma once
// Insight: shows over the picture how it was made. Each visible thing gets an outline or a tint
// that tells what it is drawn from.
// Input:  the draw list of a frame, and a layer to show.
// Output: shapes over the picture in the bound framebuffer.
// Thread: the GL thread.
// Full:   never; it keeps nothing between frames.

#include <array>
#include <cstdint>
#include <vector>

#include "protocol/base/result.h"
#include "shaders/gl/gl_object.h"
#include "shaders/gl/program.h"

namespace mirage {

struct Camera;
struct DrawList;
class SceneView;

enum class InsightLayer : std::uint8_t {
  kNone,
  kBorders,   ///< tiles: blue flat, green relief, yellow geometry, red no image
  kBound,     ///< bound over tau: green 0, yellow 1, red 2 and more
  kAge,       ///< age of tiles: green new, red a minute and older
  kGeometry,  ///< things drawn from geometry
};
inline constexpr std::size_t kInsightLayers = 4;

class Insight {
 public:
  /// Creates the programs. Error kGraphicsShader.
  static Result<Insight> create();
  /// Draws into the bound framebuffer, which has the camera's size. `tau_px` is the present tau.
  void draw(InsightLayer layer, const Camera& camera, const SceneView& scene, const DrawList& list,
            double tau_px, std::int64_t now_us);

 private:
  gl::Program program_;
  gl::VertexArray vao_;
  gl::Buffer vertices_;
};

/// Returns the RGBA colour for a share of what is tolerated: green 0, yellow 1/2, red 1 and more.
std::array<float, 4> heat(double share);

}  // namespace mirage
