/* Results and errors of libmirage-client. C99; nothing is thrown across this interface. */
#ifndef MIRAGE_ERROR_H
#define MIRAGE_ERROR_H

#include <stdint.h>

#if defined(_WIN32)
#define MIRAGE_API
#else
#define MIRAGE_API __attribute__((visibility("default")))
#endif

#define MIRAGE_CLIENT_VERSION_MAJOR 0
#define MIRAGE_CLIENT_VERSION_MINOR 1
#define MIRAGE_CLIENT_VERSION_PATCH 0
/** Version of this header, as mirage_version() returns that of the library. */
#define MIRAGE_CLIENT_VERSION                                                   \
  (MIRAGE_CLIENT_VERSION_MAJOR * 1000000 + MIRAGE_CLIENT_VERSION_MINOR * 1000 + \
   MIRAGE_CLIENT_VERSION_PATCH)

#ifdef __cplusplus
extern "C" {
#endif

/** A client of one server. Each has its own connection, scene and graphics memory. */
typedef struct mirage_client mirage_client;

/** What a function returns: 0 success, above 0 "not yet", below 0 failure. */
typedef int32_t mirage_result;
enum {
  MIRAGE_OK = 0,
  MIRAGE_NOT_YET = 1,        /**< nothing has arrived that could be drawn or returned */
  MIRAGE_BAD_ARGUMENT = -1,  /**< a value is out of range, not finite, or a pointer is NULL */
  MIRAGE_WRONG_STATE = -2,   /**< a call before it: attach, connect or plan is missing */
  MIRAGE_WRONG_THREAD = -3,  /**< not the thread of mirage_gl_attach() */
  MIRAGE_UNSUPPORTED = -4,   /**< this version of the library, or the context, cannot do it */
  MIRAGE_OUT_OF_MEMORY = -5, /**< the call ended halfway; the next update begins the session anew */
  MIRAGE_GRAPHICS = -6, /**< the GL context failed: no memory, no context, or a refused shader */
  MIRAGE_NETWORK = -7,  /**< the connection failed; the library connects again by itself */
  MIRAGE_REFUSED = -8,  /**< the server refused: the token, or full renders */
  MIRAGE_INTERNAL = -9  /**< a bug; please report it with the text */
};

/** The last failure of a client. Texts are valid until the next call with that client. */
typedef struct mirage_error {
  uint32_t size;        /**< sizeof(mirage_error) */
  mirage_result result; /**< MIRAGE_OK: nothing has failed yet */
  const char* id;       /**< stable id, as in docs/reference/errors.md */
  const char* text;     /**< what failed, one line of English */
  const char* hint;     /**< what to do about it; may be empty */
} mirage_error;

/** Returns the version of the library: major * 1000000 + minor * 1000 + patch. */
MIRAGE_API int32_t mirage_version(void);
/** Returns the name of a result, such as "wrong-state"; "unknown" for other numbers. */
MIRAGE_API const char* mirage_result_name(mirage_result result);
/** Fills `error` with the last failure of this client. Success does not clear it. */
MIRAGE_API mirage_result mirage_client_error(const mirage_client* client, mirage_error* error);

#ifdef __cplusplus
}
#endif
#endif
