#pragma once
// Draw calls of millions of elements.

#include <cstddef>

#include "shaders/gl/gl.h"

namespace mirage::gl {

/// Draws `count` elements of the bound vertex array from `first_index` on, `instances` times, as
/// glDrawElementsInstanced() with 32-bit indices. One instance of a large mesh is drawn in parts on
/// a software renderer, which waits for each part but the last two: llvmpipe would queue the work
/// of all, up to 640 MB. `mode`: points, lines or triangles.
void draw_elements(GLenum mode, std::size_t first_index, std::size_t count, std::size_t instances);

}  // namespace mirage::gl
