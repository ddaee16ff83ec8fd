#pragma once
// Codec choice: which codec to ask for tiles in, judged by the measured link.
// Input:  trips of tiles, load of the link.
// Output: the codec of the next batch.
// Thread: the frame loop's.
// Full:   never; it keeps the trips of the last tiles.
//
// A tile's trip without the server's own time (TileReply.server_us) is the link's: its way there
// and back, and the wait on it. So a slow renderer does not look like a thin link. A link is thin
// if asks are held back, the wait is the link's and few bytes arrive. The client then asks for
// lossy colours; otherwise it takes the server's own choice, without loss. It leaves lossy colours
// by other rules than it enters them: once the link delivers far more, or once lossless tiles would
// fill less than half of it for a while.

#include <cstdint>
#include <deque>
#include <optional>
#include <vector>

#include "protocol/codec/codec_id.h"

namespace mirage {

struct LinkLoad {
  double down_mbps = 0;    ///< of all messages, in the last second
  double held_back_s = 0;  ///< time for which asks have waited for the window without a break
};

class CodecChoice {
 public:
  /// `forced`: this codec, if the server has it.
  explicit CodecChoice(std::optional<TileCodec> forced = std::nullopt) : forced_(forced) {}

  /// Restarts for a new connection. `common` are the possible codecs; the first is the server's
  /// choice.
  void reset(std::vector<TileCodec> common);
  /// Notes that a tile arrived `trip_us` after its ask; the server had it for `server_us` of that.
  void tile_arrived(std::int64_t trip_us, std::int64_t server_us);
  /// Returns the codec that the server uses if the client asks for none.
  TileCodec unasked() const { return common_.front(); }
  /// Returns the codec to use from now on.
  TileCodec update(const LinkLoad& load, std::int64_t now_us);

 private:
  bool has(TileCodec codec) const;
  bool is_thin(const LinkLoad& load, std::int64_t now_us);

  std::optional<TileCodec> forced_;
  std::vector<TileCodec> common_ = {TileCodec::kZstd};
  std::deque<std::int64_t> link_us_;  ///< trips of the last tiles, without the server's time
  bool thin_ = false;
  double link_mbps_ = 0;              ///< rate when the link was last full
  std::int64_t roomy_since_us_ = -1;  ///< lossless tiles would fit since then
};

}  // namespace mirage
