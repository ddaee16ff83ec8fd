#pragma once
// Sculptures are worked out for seconds each; once made they lie in the cache directory.

#include "server/base/cache_directory.h"
#include "server/scene/builtin/sculpture.h"

namespace mirage::builtin {

/// make_sculpture(), from `cache` where it is there (nullptr: there is none).
Sculpture find_or_make_sculpture(std::uint32_t seed, std::uint32_t number, std::size_t triangles,
                                 CacheDirectory* cache);

}  // namespace mirage::builtin
