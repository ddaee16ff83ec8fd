#pragma once
// What a tile's bytes depend on beside the scene and the key: what draws and encodes it.

#include <cstdint>
#include <string>
#include <vector>

namespace mirage {

struct RenderProfile {
  int supersample = 0;              ///< per axis
  std::string renderer;             ///< GL_RENDERER and version, the driver's own among it
  std::uint64_t shaders = 0;        ///< of the text of all
  std::vector<std::string> codecs;  ///< each with the version of its library

  /// Equal profiles give equal tiles. Never 0.
  std::uint64_t hash() const;
};

/// Of this build on this renderer.
RenderProfile render_profile(const std::string& renderer, int supersample);

/// What keys and clients call the revision: of a scene as a profile draws it. Tiles in a cache's
/// directory, and at a client that reconnects, are taken for the same only under the same one.
std::uint64_t profiled_revision(std::uint64_t scene_revision, std::uint64_t profile);

}  // namespace mirage
