#pragma once
// Insight: over the picture, how it came about. Each thing in view gets an outline, or a tint, of
// what it is drawn from. Thread: the GL one.

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
  kBorders,   ///< of tiles: blue flat, green relief, yellow geometry, red without an image
  kBound,     ///< bound over tau: green 0, yellow 1, red 2 and more
  kAge,       ///< of tiles: green new, red a minute and older
  kGeometry,  ///< what is drawn from geometry
};
inline constexpr std::size_t kInsightLayers = 4;

class Insight {
 public:
  /// Error kGraphicsShader.
  static Result<Insight> create();
  /// Into the bound framebuffer, whose size the camera has. `tau_px` as allowed now.
  void draw(InsightLayer layer, const Camera& camera, const SceneView& scene, const DrawList& list,
            double tau_px, std::int64_t now_us);

 private:
  gl::Program program_;
  gl::VertexArray vao_;
  gl::Buffer vertices_;
};

/// The colour of a share of what is tolerable, RGBA: green 0, yellow 1/2, red 1 and more.
std::array<float, 4> heat(double share);

}  // namespace mirage
