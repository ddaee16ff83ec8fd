#pragma once
// Tile trace: the life of every tile, for `--trace` and for measuring.

#include <cstddef>
#include <cstdint>
#include <vector>

namespace mirage {

/// A tile's life, from request to first draw. Times are those of the session's clock.
struct TileLife {
  std::uint32_t request_id = 0, object = 0, instance = 0, edge = 0;
  std::int64_t asked_us = 0;
  std::int64_t received_us = 0;      ///< when the link had it: after the server's time and the way
  std::int64_t uploaded_us = 0;      ///< when it was decoded and uploaded
  std::int64_t first_drawn_us = -1;  ///< -1: never
  std::uint32_t server_queue_us = 0, server_render_us = 0, server_encode_us = 0;
  std::size_t bytes = 0;
};

class TileTrace {
 public:
  /// Adds a life. Returns its place.
  std::size_t begin(const TileLife& life) {
    lives_.push_back(life);
    return lives_.size() - 1;
  }
  void uploaded(std::size_t place, std::int64_t now_us) {
    if (place < lives_.size()) lives_[place].uploaded_us = now_us;
  }
  /// Notes that the frame that begins now draws it for the first time.
  void first_in_frame(std::size_t place, std::int64_t now_us) {
    if (place >= lives_.size()) return;
    lives_[place].first_drawn_us = now_us;
    in_frame_.push_back(place);
  }
  /// Notes that the frame is drawn.
  void frame_drawn(std::int64_t now_us) {
    for (const std::size_t place : in_frame_) lives_[place].first_drawn_us = now_us;
    in_frame_.clear();
  }
  const std::vector<TileLife>& lives() const { return lives_; }

 private:
  std::vector<TileLife> lives_;
  std::vector<std::size_t> in_frame_;
};

}  // namespace mirage
