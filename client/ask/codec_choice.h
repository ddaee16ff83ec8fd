#pragma once
// Which codec to ask for tiles in, from what the link is measured to do.
// Input:  trips of tiles, load of the link. Output: the codec of the next batch. Thread: the frame
//         loop's. Never full: keeps the trips of the last tiles.
//
// A tile's trip without the server's own time (TileReply.server_us) is the link's: its way there
// and back and what waits at it. So a slow renderer does not pass for a thin link. A link is thin
// when asks are held back, the wait is the link's and little comes through: lossy colours. Else it
// is the server's own choice, without loss. Lossy colours are left by another measure than they are
// entered by: once the link delivers far more, or once tiles without loss would fill less than half
// of it for a while.

#include <cstdint>
#include <deque>
#include <optional>
#include <vector>

#include "protocol/codec/tile_codec.h"

namespace mirage {

struct LinkLoad {
  double down_mbps = 0;    ///< of everything, in the last second
  double held_back_s = 0;  ///< asks have waited for the window without a break
};

class CodecChoice {
 public:
  /// `forced`: this one if the server has it.
  explicit CodecChoice(std::optional<TileCodec> forced = std::nullopt) : forced_(forced) {}

  /// A new connection: what may be asked for; the first is the server's own choice.
  void reset(std::vector<TileCodec> common);
  /// A tile came `trip_us` after it was asked for, of which the server had it for `server_us`.
  void tile_arrived(std::int64_t trip_us, std::int64_t server_us);
  /// What comes when nothing else is asked for.
  TileCodec unasked() const { return common_.front(); }
  /// The codec from now on.
  TileCodec update(const LinkLoad& load, std::int64_t now_us);

 private:
  bool has(TileCodec codec) const;
  bool is_thin(const LinkLoad& load, std::int64_t now_us);

  std::optional<TileCodec> forced_;
  std::vector<TileCodec> common_ = {TileCodec::kZstd};
  std::deque<std::int64_t> link_us_;  ///< of the last tiles, without the server's time
  bool thin_ = false;
  double link_mbps_ = 0;              ///< what came through when it was last full
  std::int64_t roomy_since_us_ = -1;  ///< tiles without loss would fit since then
};

}  // namespace mirage
