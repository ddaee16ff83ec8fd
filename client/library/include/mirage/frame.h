/* Frames of libmirage-client: plan, draw, account. C99. Functions marked GL need the context of
 * mirage_gl_attach() current, and restore its state: enables, depth, blend, cull, colour mask,
 * viewport, scissor, clip control, clear values, polygon mode, framebuffers, program, vertex array,
 * buffers, the textures and samplers of units 0 to 15, pixel store, and generic attribute 5. */
#ifndef MIRAGE_FRAME_H
#define MIRAGE_FRAME_H

#include <mirage/error.h>

#ifdef __cplusplus
extern "C" {
#endif

/** How your projection maps distance to window depth, with glDepthRange(0, 1). */
enum {
  MIRAGE_DEPTH_FORWARD = 0,    /**< near is 0; far_m 0: without a far plane */
  MIRAGE_DEPTH_REVERSED = 1,   /**< near is 1, as with GL_ZERO_TO_ONE; far_m 0: the same */
  MIRAGE_DEPTH_LOGARITHMIC = 2 /**< log2(1 + distance) / log2(1 + far_m) */
};

/** How your framebuffer keeps colour. */
enum {
  MIRAGE_COLOR_BY_SHADER = 0, /**< sRGB values in a plain format, such as a window's */
  MIRAGE_COLOR_SRGB = 1,      /**< an sRGB format that encodes, with GL_FRAMEBUFFER_SRGB */
  MIRAGE_COLOR_LINEAR = 2     /**< linear light, such as GL_RGBA16F */
};

/** Most views of a frame. */
#define MIRAGE_MOST_VIEWS 4

/** A perspective camera in your world. */
typedef struct mirage_view {
  uint32_t size;
  int32_t depth; /**< MIRAGE_DEPTH_ */
  double eye[3];
  double rotation[4]; /**< unit quaternion x, y, z, w, world from camera; the camera looks along its
                           -z, +y is up; all 0: none */
  /** Tangents of the angles to the picture's edges, with signs: left and down are below right and
   * up. A symmetric camera has left = -right. */
  double tan_left, tan_right, tan_down, tan_up;
  /** Of your depth buffer, in units of your world. Nothing is cut off there. */
  double near_m, far_m;
  int32_t width, height; /**< px, 1 to 16384 */
} mirage_view;

/** A framebuffer of yours, and the lower left corner of the picture in it. */
typedef struct mirage_target {
  uint32_t size;
  uint32_t framebuffer; /**< 0: the window's */
  int32_t x, y;         /**< px */
  int32_t color;        /**< MIRAGE_COLOR_ */
  int32_t no_depth;     /**< 1: drawn over everything, and no depth is written */
} mirage_target;

/** The picture as textures of the library, until the next call with this client. */
typedef struct mirage_textures {
  uint32_t size;
  uint32_t color;            /**< GL_SRGB8_ALPHA8, premultiplied; alpha: share that objects cover */
  uint32_t depth;            /**< GL_DEPTH_COMPONENT32F */
  int32_t width, height;     /**< of both; the picture may be drawn smaller than the view */
  double window_x, window_y; /**< value of `depth` = x + y / distance along the view */
} mirage_textures;

/** What mirage_draw() will do with a planned frame. */
enum { MIRAGE_STEP_KEEP = 0, MIRAGE_STEP_DRAW = 1, MIRAGE_STEP_REFINE = 2 };

/** A planned frame, all its views together. */
typedef struct mirage_frame_info {
  uint32_t size;
  int32_t step;    /**< MIRAGE_STEP_, the greatest of any view */
  int32_t at_rest; /**< 1: nothing is under way; further frames of this view would not differ */
  int32_t samples; /**< of a pixel */
  double scale;    /**< edge of a new picture over that of the view; at rest it is refined at 1 */
  uint32_t impostors, meshes, placeholders; /**< drawn by each; placeholders have no image yet */
  uint32_t over_tau;    /**< things in view with a greater error bound than tau allows */
  double bound_px;      /**< greatest proven error of a drawn impostor, px */
  double expected_flip; /**< mean FLIP over things, as the plan expects it */
} mirage_frame_info;

/** An image of the server's full render. */
typedef struct mirage_image {
  uint32_t size;
  int32_t width, height;
  int32_t reserved;
  const uint8_t* rgba; /**< rows from the top, sRGB; valid until the next call with this client */
  uint64_t bytes;
} mirage_image;

/** GL. Plans a frame of 1 to MIRAGE_MOST_VIEWS views, such as two eyes or the parts of a window,
 * and sends asks. All views share the frame's budget, and what the library holds. Put the one that
 * matters most first: there the server's quick first picture is asked for. `info` may be NULL.
 * MIRAGE_NOT_YET: there is nothing to draw yet. Errors: MIRAGE_BAD_ARGUMENT, MIRAGE_WRONG_STATE,
 * MIRAGE_GRAPHICS. */
MIRAGE_API mirage_result mirage_plan(mirage_client* client, const mirage_view* views, int32_t count,
                                     int64_t now_us, mirage_frame_info* info);
/** GL. Draws a planned view, the first one is 0, and lays it into your framebuffer by depth:
 * mirage_draw_textures() and mirage_composite(). Draw opaque things of your own before or after. */
MIRAGE_API mirage_result mirage_draw(mirage_client* client, int32_t view,
                                     const mirage_target* target);
/** GL. Draws a planned view into textures of the library. */
MIRAGE_API mirage_result mirage_draw_textures(mirage_client* client, int32_t view,
                                              mirage_textures* textures);
/** GL. Lays the picture that was drawn last into your framebuffer. */
MIRAGE_API mirage_result mirage_composite(mirage_client* client, int32_t view,
                                          const mirage_target* target);
/** Tells what the last frame took on the GPU, so that later ones keep within their budget;
 * 0: unknown. */
MIRAGE_API mirage_result mirage_frame_done(mirage_client* client, int64_t gpu_us);
/** Finds roughly what lies under a pixel of a planned view (from the top left): the distance
 * along the view of the convex hull around the nearest object that the eye is outside of, in units
 * of your world. MIRAGE_NOT_YET: there is none. For the distance of the pixel itself, read the
 * depth of mirage_draw_textures(). No GL. */
MIRAGE_API mirage_result mirage_depth_at(const mirage_client* client, int32_t view, double x,
                                         double y, double* distance);
/** Asks for the server's full render of a view, out of band. The server may refuse them. */
MIRAGE_API mirage_result mirage_reference_ask(mirage_client* client, const mirage_view* view);
/** Returns the full render once it is here; MIRAGE_NOT_YET until then. */
MIRAGE_API mirage_result mirage_reference_take(mirage_client* client, mirage_image* image);

#ifdef __cplusplus
}
#endif
#endif
