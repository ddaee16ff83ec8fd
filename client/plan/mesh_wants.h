#pragma once
// Mesh wants: the geometry that planning wants, object by object. The mesh cache finds out which of
// it is missing.

#include <cstdint>
#include <map>
#include <vector>

namespace mirage {

struct MeshWant;
struct SelectorInput;

/// The instances that should be drawn as geometry.
struct MeshWants {
  std::vector<std::uint32_t> instances;
  std::map<std::uint32_t, double> gain;  ///< gain of each object (ask_gain.h)
};

/// Returns the wants by object, each for its nearest instance to the predicted camera.
std::vector<MeshWant> mesh_wants(const SelectorInput& in, const MeshWants& wants);

}  // namespace mirage
