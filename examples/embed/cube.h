/* The host's own part of the example: a lit cube, drawn with the same camera as Mirage's picture.
 */
#ifndef CUBE_H
#define CUBE_H

#include <mirage/client.h>
#include <mirage/frame.h>

/** Makes the cube's program. A GL context of version 3.3 is current. */
void make_cube(void);
/** Clears the window's framebuffer. */
void start_picture(int width, int height);
/** Draws a cube where the home view looks. */
void draw_cube(const mirage_view* view, const mirage_scene_info* scene);
/** Writes the window's back buffer as a PPM file. */
void save_picture(const char* path, int width, int height);

#endif
