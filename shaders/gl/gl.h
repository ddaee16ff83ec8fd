#pragma once
// The only file that includes OpenGL. Entry points come from GLVND's libOpenGL; there is no loader.
// In a browser it is OpenGL ES 3.0, which is WebGL 2.

#ifdef __EMSCRIPTEN__
#include <GLES3/gl3.h>
#else
#ifndef GL_GLEXT_PROTOTYPES
#define GL_GLEXT_PROTOTYPES
#endif
#include <GL/gl.h>
#include <GL/glext.h>
#endif
