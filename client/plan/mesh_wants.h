#pragma once
// What geometry planning wants, object by object, for the mesh cache to say what of it is missing.

#include <cstdint>
#include <map>
#include <vector>

namespace mirage {

struct Camera;
struct MeshWant;
class SceneView;
class ViewFit;

/// What should be geometry.
struct MeshWants {
  std::vector<std::uint32_t> instances;
  std::map<std::uint32_t, double> gain;  ///< of each object of them (ask_gain.h)
};

/// The same by object, each as its nearest instance takes it at `camera`. `view`: of the view tile,
/// which shows some of them meanwhile; nullptr: there is none.
std::vector<MeshWant> mesh_wants(const SceneView& scene, const Camera& camera, double tau_px,
                                 const MeshWants& wants, const ViewFit* view);

}  // namespace mirage
