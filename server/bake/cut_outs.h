#pragma once
#include <cstddef>

namespace mirage {

struct Scene;

/// Alpha-tests blended materials whose image is a cut-out: fully there or absent in nearly every
/// texel, as leaves are. A tested surface has depth, which impostors need; a blended one has none.
/// Returns the number of materials changed.
std::size_t test_cut_outs(Scene& scene);

}  // namespace mirage
