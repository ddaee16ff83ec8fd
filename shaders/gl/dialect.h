#pragma once
// Differences between OpenGL 3.3 and OpenGL ES 3.0 (WebGL 2). They are queried from the current
// context and hidden from all drawing code.

#include <string>

#include "shaders/gl/gl.h"

namespace mirage::gl {

/// True if the current context is OpenGL ES.
bool is_embedded();
/// Returns the first lines of every shader: version, and precisions if the language has no
/// defaults.
std::string shader_header();
/// Turns the encoding of writes to sRGB targets on or off; OpenGL ES always encodes.
void encode_srgb(bool on);
/// shade_samples() makes shaders run for every sample of a pixel; OpenGL ES 3.0 has no sample
/// shading. prepare_points_and_samples() lets shaders set the size of points, as OpenGL ES always
/// does.
void shade_samples(bool on);
void prepare_points_and_samples();
/// has_clip_control() is true if clip-space depth can run from 0 to 1 (GL 4.5, ARB_ or
/// EXT_clip_control); the other function sets that.
bool has_clip_control();
void set_clip_depth_zero_to_one(bool on);
/// True if targets of 32-bit floats can be drawn to and blended.
bool blends_floats();
/// Returns GL_RENDERER as far as the context reveals it: browsers hide it behind an extension.
std::string renderer_name();

}  // namespace mirage::gl
