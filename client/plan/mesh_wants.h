#pragma once
// Mesh wants: the geometry that planning wants, object by object. The mesh cache finds out which of
// it is missing.

#include <cstdint>
#include <map>
#include <vector>

namespace mirage {

struct Camera;
struct MeshWant;
class SceneView;
class ViewFit;

/// The instances that should be drawn as geometry.
struct MeshWants {
  std::vector<std::uint32_t> instances;
  std::map<std::uint32_t, double> gain;  ///< gain of each object (ask_gain.h)
};

/// Returns the wants by object, each for its nearest instance at `camera`. `view` tells how well
/// the view tile shows them meanwhile; nullptr: there is none.
std::vector<MeshWant> mesh_wants(const SceneView& scene, const Camera& camera, double tau_px,
                                 const MeshWants& wants, const ViewFit* view, double time_s);

}  // namespace mirage
