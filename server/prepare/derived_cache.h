#pragma once
// Data derived from meshes and images when a scene is loaded, kept in the cache directory under a
// hash of all its inputs.

#include "server/base/cache_directory.h"
#include "server/prepare/object_geometry.h"

namespace mirage {

/// Returns a hash of each image, for the keys of data that depends on images.
std::vector<std::uint64_t> hash_images(const Scene& scene, const Workers& workers);

/// Returns make_geometry() of `object`, from `cache` if it is there (nullptr: no cache).
/// `image_hashes` are the scene's; only a cache needs them.
ObjectGeometry find_or_make_geometry(const Scene& scene, const SceneObject& object,
                                     ObjectDescription& description, CacheDirectory* cache,
                                     const std::vector<std::uint64_t>& image_hashes,
                                     const LodFamilies& families, const Workers& workers);

/// Returns the mip levels of the scene's images, cached in the same way. Alpha-tested images get
/// alpha_preserving_mips(); the others get none, as the driver's will do.
std::vector<std::vector<Image>> make_mips(const Scene& scene, CacheDirectory* cache = nullptr,
                                          const Workers& workers = Workers());

}  // namespace mirage
