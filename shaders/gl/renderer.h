#pragma once
// What draws: a graphics card or the CPU. Depths, sizes and sample counts are chosen by it.

#include <string>

#include "shaders/gl/gl.h"

namespace mirage::gl {

/// Whether a renderer of this name (GL_RENDERER) is the CPU.
bool is_software(const std::string& renderer);
/// Of the current context.
bool is_software();

/// Format of a target that ends up as sRGB bytes. 16-bit float where surfaces are `blended`, as 8
/// bits would round at each, and on a software renderer: converting to sRGB and back costs it more
/// than the bytes do (tiles 8 %, client frames 5 to 10 %). sRGB of 8 bits else.
GLenum color_format(bool blended);

}  // namespace mirage::gl
