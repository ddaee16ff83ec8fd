#pragma once
// What is derived from meshes and images when a scene is loaded, kept in the cache directory under
// a hash of all that it is made from.

#include "server/base/cache_directory.h"
#include "server/prepare/object_geometry.h"

namespace mirage {

/// A hash of each image, for the keys of what looks at them.
std::vector<std::uint64_t> hash_images(const Scene& scene, const Workers& workers);

/// make_geometry() of `object`, from `cache` where it is there (nullptr: there is none).
/// `image_hashes` are the scene's; only a cache needs them.
ObjectGeometry find_or_make_geometry(const Scene& scene, const SceneObject& object,
                                     ObjectDescription& description, CacheDirectory* cache,
                                     const std::vector<std::uint64_t>& image_hashes,
                                     const LodFamilies& families, const Workers& workers);

/// Mip levels of the scene's images in the same way: gl::alpha_preserving_mips() of those that are
/// tested for alpha, none where the driver's will do.
std::vector<std::vector<Image>> make_mips(const Scene& scene, CacheDirectory* cache = nullptr,
                                          const Workers& workers = Workers());

}  // namespace mirage
