#pragma once
// The kind of renderer: a graphics card or the CPU. Depths, sizes and sample counts depend on it.

#include <string>

#include "shaders/gl/gl.h"

namespace mirage::gl {

/// True if a renderer of this name (GL_RENDERER) is the CPU.
bool is_software(const std::string& renderer);
/// True if the current context's renderer is the CPU.
bool is_software();

/// Returns the format of a target that ends up as sRGB bytes. It is 16-bit float if surfaces are
/// `blended`, because 8 bits would round at each layer. It is also float on a software renderer,
/// for which converting to sRGB and back costs more than the bytes do (tiles 8 %, client frames 5
/// to 10 %). Otherwise it is sRGB with 8 bits.
GLenum color_format(bool blended);

/// True if shaders can run for every sample of a multisampled target: OpenGL 4.0 or
/// ARB_sample_shading. softpipe and OpenGL ES 3.0 cannot; they test alpha once a pixel.
bool has_sample_shading();
/// Lets shaders set the size of points, as OpenGL ES always does.
void let_shaders_size_points();

}  // namespace mirage::gl
