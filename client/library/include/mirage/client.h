/* libmirage-client: draws a scene of a Mirage server into your program. C99.
 *
 *   create -> connect, attach (in any order) -> each frame: update, plan, draw, frame_done
 *          -> detach -> destroy
 *
 * Structs: set `size` to sizeof, and everything else to zero, then what you need. Zero means the
 * default. The library reads no more than `size` bytes, so older programs run with newer libraries.
 * Axes: +y is up, as in glTF, until you turn the scene.
 * Units: metres of the server's scene, microseconds of a clock of yours that never goes back.
 * Threads: one client belongs to one thread at a time, from attach to detach to the thread of its
 * GL context. Different clients are independent. Library threads never touch GL and block all
 * signals. Graphics: OpenGL 3.3 core or later, or OpenGL ES 3.0, through GLVND's libOpenGL. The
 * library never makes a context current. GL calls are made only by functions that say so. They
 * leave the state of the context as they found it; frame.h names the exceptions. */
#ifndef MIRAGE_CLIENT_H
#define MIRAGE_CLIENT_H

#include <mirage/error.h>

#ifdef __cplusplus
extern "C" {
#endif

enum { MIRAGE_LOG_WARNING = 1, MIRAGE_LOG_ERROR = 2 };

/** What a client is made with. Texts are copied. */
typedef struct mirage_client_desc {
  uint32_t size;
  int32_t version; /**< MIRAGE_CLIENT_VERSION: another major version is refused */
  void* user;      /**< handed to the two functions below */
  /** Takes a line for a log; may be NULL. Called within calls of yours. It must not call back. */
  void (*log)(void* user, int32_t level, const char* text);
  /** Called by a thread of the library when something has arrived, so that a program at rest can
   * call mirage_update(); may be NULL. It must not call back. */
  void (*wake)(void* user);
  const char* name;    /**< of your program, for the server's log; NULL: "libmirage-client" */
  const char* ca_file; /**< PEM file of certificates to trust beside the system's; NULL: none */
  int32_t atlas_mb;    /**< graphics memory for impostors, 1 to 4096; 0: 192 */
  int32_t geometry_mb; /**< graphics memory for meshes and their images, 1 to 65536; 0: 256 */
  double tau_px;       /**< error that an impostor may show, px, 0.01 to 1000; 0: 1 */
  /** Samples of a pixel, 1 to 16; 0: 4, or 1 where that pays within the budget of a frame. */
  int32_t samples;
} mirage_client_desc;

/** What may change from frame to frame. */
typedef struct mirage_options {
  uint32_t size;
  int32_t no_sky;  /**< 1: nothing is drawn where the scene has no object */
  int32_t paused;  /**< 1: what moves in the scene stands still */
  double frame_ms; /**< time a frame may take to draw, ms, up to 10,000; 0: 50 on a software
                        renderer, else 16 */
} mirage_options;

/** A light. Each has the colour, linear RGB times intensity: irradiance over pi. */
typedef struct mirage_light {
  double direction[3]; /**< in which the light travels, scene space; any length but 0 */
  double color[3];
} mirage_light;

/** Lighting of the scene by directional lights. */
typedef struct mirage_lighting {
  uint32_t size;
  int32_t count; /**< lights, 0 to 16 */
  const mirage_light* lights;
  double ambient[3]; /**< linear radiance from everywhere */
} mirage_lighting;

/** Where the scene stands in your world: first scaled, then turned, then moved. */
typedef struct mirage_transform {
  uint32_t size;
  int32_t reserved;
  double rotation[4];    /**< unit quaternion x, y, z, w; all 0: none */
  double translation[3]; /**< in units of your world */
  double scale;          /**< units of your world per metre of the scene, above 0; 0: 1 */
} mirage_transform;

/** What is known of the scene. */
typedef struct mirage_scene_info {
  uint32_t size;
  int32_t complete;  /**< 1: all of it is described; until then only a view of it can be drawn */
  uint64_t revision; /**< changes with the content */
  const char* name;  /**< valid until the next call with this client */
  double center[3];  /**< of a sphere around the scene, in your world */
  double radius;
  double home_eye[3];  /**< where a viewer of 60 degrees from bottom to top
                           begins, in your world */
  double home_look[3]; /**< a point that it looks at */
  uint64_t objects, instances, triangles;
} mirage_scene_info;

/** What mirage_update() found; several bits. */
enum {
  MIRAGE_EVENT_SCENE = 1,  /**< another scene, or more of it, can be drawn */
  MIRAGE_EVENT_REDRAW = 2, /**< something arrived: the next picture may differ */
  MIRAGE_EVENT_UP = 4,     /**< connected */
  MIRAGE_EVENT_DOWN = 8,   /**< the connection is gone; what is here stays, and it connects again */
  MIRAGE_EVENT_PROBLEM = 16 /**< mirage_client_error() tells a new problem */
};

/** Makes a client. No GL, no network. Errors: MIRAGE_BAD_ARGUMENT, MIRAGE_UNSUPPORTED (another
 * major version), MIRAGE_OUT_OF_MEMORY. On failure `*client` is NULL. */
MIRAGE_API mirage_result mirage_client_create(const mirage_client_desc* desc,
                                              mirage_client** client);
/** Ends a client. Detach before; without, its GL objects are left to the context. NULL is fine. */
MIRAGE_API void mirage_client_destroy(mirage_client* client);

/** Begins to connect, and returns at once. `url` as a server's ready line prints it (ws://, wss://,
 * http://, https:// or unix:PATH; ?clip=NAME&variant=NAME choose). `token`: NULL for servers
 * without. It connects again by itself whenever the connection is lost. Called again, it leaves the
 * old server; the last picture stays until there is one of the new. */
MIRAGE_API mirage_result mirage_connect(mirage_client* client, const char* url, const char* token);
/** Ends the connection. What has arrived stays drawable. */
MIRAGE_API mirage_result mirage_disconnect(mirage_client* client);

/** GL. Makes programs and targets in the current context. Errors: MIRAGE_GRAPHICS (the text names
 * the version that is needed), MIRAGE_WRONG_STATE (attached). */
MIRAGE_API mirage_result mirage_gl_attach(mirage_client* client);
/** GL. Deletes them. `context_lost` other than 0: the context is gone, so names are forgotten and
 * GL is not called. Attach again in the new context: everything arrives anew. */
MIRAGE_API mirage_result mirage_gl_detach(mirage_client* client, int32_t context_lost);

/** GL. Takes in what has arrived, within the upload budget of a frame, and sends asks. `now_us`
 * never goes back. `events` takes MIRAGE_EVENT_ bits; may be NULL. */
MIRAGE_API mirage_result mirage_update(mirage_client* client, int64_t now_us, uint32_t* events);

/** Changes options from the next frame on. */
MIRAGE_API mirage_result mirage_set_options(mirage_client* client, const mirage_options* options);
MIRAGE_API mirage_result mirage_get_options(const mirage_client* client, mirage_options* options);
/** Lights the scene anew. Kept for later connections; NULL: the scene's own from the next one on.
 */
MIRAGE_API mirage_result mirage_set_lighting(mirage_client* client,
                                             const mirage_lighting* lighting);
/** Sets where the scene stands. Other scales than a uniform one cannot be said. */
MIRAGE_API mirage_result mirage_set_transform(mirage_client* client,
                                              const mirage_transform* transform);
/** Tells about the scene. MIRAGE_NOT_YET until the server has described it. */
MIRAGE_API mirage_result mirage_scene(const mirage_client* client, mirage_scene_info* info);

#ifdef __cplusplus
}
#endif
#endif
