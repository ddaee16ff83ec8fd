#pragma once
// Keeps sculptures, each of which takes seconds to compute, in the cache directory.

#include "server/base/cache_directory.h"
#include "server/scene/builtin/sculpture.h"

namespace mirage::builtin {

/// Returns make_sculpture(), from `cache` if it is there (nullptr: no cache).
Sculpture find_or_make_sculpture(std::uint32_t seed, std::uint32_t number, std::size_t triangles,
                                 CacheDirectory* cache);

}  // namespace mirage::builtin
