#pragma once
// The one place that includes OpenGL. Entry points come from GLVND's libOpenGL; no loader.

#ifndef GL_GLEXT_PROTOTYPES
#define GL_GLEXT_PROTOTYPES
#endif
#include <GL/gl.h>
#include <GL/glext.h>
