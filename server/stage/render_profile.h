#pragma once
// The renderer and encoders, on which a tile's bytes depend besides scene and key.

#include <cstdint>
#include <string>
#include <vector>

namespace mirage {

struct RenderProfile {
  int supersample = 0;              ///< per axis
  std::string renderer;             ///< GL_RENDERER and GL_VERSION, which name the driver
  std::uint64_t shaders = 0;        ///< hash of all shader texts
  std::vector<std::string> codecs;  ///< each with the version of its library

  /// Returns a hash, never 0. Equal profiles give equal tiles.
  std::uint64_t hash() const;
};

/// Returns the profile of this build on this renderer.
RenderProfile render_profile(const std::string& renderer, int supersample);

/// Returns the revision of keys and clients: that of a scene as drawn by a profile. Tiles in a
/// cache directory, or kept by a reconnecting client, are reused only under an equal revision.
std::uint64_t profiled_revision(std::uint64_t scene_revision, std::uint64_t profile);

}  // namespace mirage
