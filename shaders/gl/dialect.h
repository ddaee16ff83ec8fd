#pragma once
// What differs between OpenGL 3.3 and OpenGL ES 3.0 (WebGL 2): asked of the current context, hidden
// from all who draw.

#include <string>

#include "shaders/gl/gl.h"

namespace mirage::gl {

/// Whether the current context is OpenGL ES.
bool is_embedded();
/// The first lines of every shader: version, and precisions where the language has none by default.
const char* shader_header();
/// Whether what is written to an sRGB target is encoded; OpenGL ES always does.
void encode_srgb(bool on);
/// Whether a shader runs for every sample of a pixel, and points have the size it says. OpenGL ES
/// 3.0 has no sample shading, and always has the other.
void shade_samples(bool on);
void prepare_points_and_samples();
/// Whether depth can run from 0 to 1 in clip space (GL 4.5, ARB_ or EXT_clip_control); sets it.
bool has_clip_control();
void set_clip_depth_zero_to_one(bool on);
/// Whether targets of 32-bit floats can be drawn to and blended.
bool blends_floats();
/// GL_RENDERER, as far as the context tells: browsers hide it behind an extension.
std::string renderer_name();

}  // namespace mirage::gl
