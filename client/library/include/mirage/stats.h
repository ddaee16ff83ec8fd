/* Statistics of libmirage-client. C99. */
#ifndef MIRAGE_STATS_H
#define MIRAGE_STATS_H

#include <mirage/error.h>

#ifdef __cplusplus
extern "C" {
#endif

/** Counts since the last connect, and present values. */
typedef struct mirage_stats {
  uint32_t size;
  int32_t connected;
  uint64_t bytes_up, bytes_down; /**< with headers */
  uint64_t tiles_asked, tiles_received, tiles_drawn, tiles_refused;
  uint64_t in_flight;    /**< asks without an answer yet */
  int64_t round_trip_us; /**< 0: not known yet */
  uint64_t gpu_bytes;    /**< graphics memory that the client holds */
  uint64_t frames;       /**< planned ones */
  uint32_t draw_calls;   /**< of the last picture */
  uint32_t reserved;
  double tau_px; /**< error that impostors may show now */
} mirage_stats;

/** Fills `stats`. MIRAGE_NOT_YET before the first update of a connected, attached client. */
MIRAGE_API mirage_result mirage_get_stats(const mirage_client* client, mirage_stats* stats);

#ifdef __cplusplus
}
#endif
#endif
