#pragma once
// Frame work: what drawing a frame takes, counted in the kinds of work that have a price
// (cost_model.h). The form is that of Wimmer & Wonka, "Rendering time estimation for real-time
// rendering", 2003. All of it is known before anything is drawn.

#include <array>
#include <cstddef>
#include <cstdint>
#include <glm/glm.hpp>
#include <vector>

#include "client/frame/resident.h"

namespace mirage {

struct Camera;
struct DrawnMesh;

struct PlannedFrame;
class SceneView;

enum class Work : std::uint8_t {
  kFrame,                 ///< 1 a frame
  kPixel,                 ///< px of the target
  kSample,                ///< px of the target, times the samples after a pixel's first
  kMesh,                  ///< levels of geometry in the frame, a few draw calls each
  kTriangle,              ///< triangles of opaque geometry
  kTestedTriangle,        ///< triangles of geometry with an alpha test
  kTestedTriangleSample,  ///< the same triangles, times the samples after a pixel's first
  kMeshPixel,             ///< px covered by opaque geometry
  kTestedPixel,           ///< px covered by geometry with an alpha test
  kTestedSample,          ///< the same pixels, times the samples after the first
  kFlatPixel,             ///< px of impostors on quads and hulls
  kReliefPixel,           ///< px of impostors by marched depth
  kImpostorSample,        ///< px of impostors, times the samples after the first
  kViewPixel,             ///< px shown from the view tile
  kCount
};
inline constexpr std::size_t kWorks = static_cast<std::size_t>(Work::kCount);

/// Returns the name that files and tables use for the kind.
const char* work_name(Work kind);

/// An amount of each kind of work, finite and >= 0.
struct FrameWork {
  std::array<double, kWorks> amount{};

  double& operator[](Work kind) { return amount[static_cast<std::size_t>(kind)]; }
  double operator[](Work kind) const { return amount[static_cast<std::size_t>(kind)]; }
  FrameWork& operator+=(const FrameWork& other);
};

/// Returns the screen area, px, of a sphere (centre relative to the eye, m) as far as it is in the
/// view, at most the whole view. It is the area of the square around the sphere, cut to the view,
/// times pi / 4.
double shown_area_px(const Camera& camera, const glm::dvec3& center, double radius);

/// Returns the work that every frame of this size takes. `samples` of a pixel is >= 1, here and
/// below.
FrameWork target_work(const Camera& camera, int samples);
/// Returns the work of an instance drawn from this level of its geometry. It leaves out what the
/// level takes once a frame.
FrameWork mesh_work(const SceneView& scene, const Camera& camera, std::uint32_t instance,
                    std::size_t lod, int samples);
/// Returns the work of an instance drawn from a tile.
FrameWork impostor_work(const SceneView& scene, const Camera& camera, std::uint32_t instance,
                        const TileRecord& tile, DrawMethod method, int samples);
/// Returns the work of everything in the list.
FrameWork work_of(const PlannedFrame& frame, const Camera& drawn_camera, int samples);

}  // namespace mirage
