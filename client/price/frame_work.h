#pragma once
// What drawing a frame amounts to, counted in the kinds of work that have a price (cost_model.h):
// the form of Wimmer & Wonka, "Rendering time estimation for real-time rendering", 2003.
// All of it is known before anything is drawn.

#include <array>
#include <cstddef>
#include <cstdint>
#include <glm/glm.hpp>
#include <vector>

#include "client/frame/resident.h"

namespace mirage {

struct Camera;
struct DrawnMesh;

struct DrawList;
class SceneView;

enum class Work : std::uint8_t {
  kFrame,                 ///< 1 a frame
  kPixel,                 ///< px of the target
  kSample,                ///< px times the samples after a pixel's first
  kMesh,                  ///< levels of geometry in the frame, each a few draw calls
  kTriangle,              ///< of opaque geometry
  kTestedTriangle,        ///< of geometry with an alpha test
  kTestedTriangleSample,  ///< the same times the samples after a pixel's first
  kMeshPixel,             ///< px covered by opaque geometry
  kTestedPixel,           ///< px covered by geometry with an alpha test
  kTestedSample,          ///< the same times the samples after the first
  kFlatPixel,             ///< px of impostors on quads and hulls
  kReliefPixel,           ///< px of impostors by marched depth
  kImpostorSample,        ///< px of impostors times the samples after the first
  kViewPixel,             ///< px shown from the view tile
  kCount
};
inline constexpr std::size_t kWorks = static_cast<std::size_t>(Work::kCount);

/// As files and tables name it.
const char* work_name(Work kind);

/// Amounts of each kind, all finite and >= 0.
struct FrameWork {
  std::array<double, kWorks> amount{};

  double& operator[](Work kind) { return amount[static_cast<std::size_t>(kind)]; }
  double operator[](Work kind) const { return amount[static_cast<std::size_t>(kind)]; }
  FrameWork& operator+=(const FrameWork& other);
};

/// Screen area, px, of a sphere (centre relative to the eye, m) as far as the view shows it, at
/// most all of it: that of the square around it, cut to the view, times pi / 4.
double shown_area_px(const Camera& camera, const glm::dvec3& center, double radius);

/// Of all frames of this size. `samples` of a pixel, >= 1, here and below.
FrameWork target_work(const Camera& camera, int samples);
/// Of an instance drawn from this level of its geometry, without what its level takes once a frame.
FrameWork mesh_work(const SceneView& scene, const Camera& camera, std::uint32_t instance,
                    std::size_t lod, int samples);
/// Of an instance drawn from a tile.
FrameWork impostor_work(const SceneView& scene, const Camera& camera, std::uint32_t instance,
                        const TileRecord& tile, DrawMethod method, int samples);
/// Of all that the list draws.
FrameWork work_of(const SceneView& scene, const Camera& camera, const DrawList& list, int samples);

}  // namespace mirage
