#pragma once
// Answered keys: the tiles that the server has sent since the eye came to rest. Nobody asks for
// them again: a tile is a pure function of its key, so a second answer would hold nothing new.
// Usually the cache holds the tile and nobody needs it any more. It may have had no room, or may
// have given it up for another tile; asking again would then go on for ever.
// Input:  answers as they arrive, the needs of each frame.
// Output: the needs that have no answer yet.
// Thread: the frame loop's.
// Full:   never; an eye that moves makes it forget.

#include <cstdint>
#include <map>
#include <tuple>
#include <vector>

#include "client/plan/tile_need.h"

namespace mirage {

class AnsweredKeys {
 public:
  void reset() { answers_.clear(); }
  /// Notes an answer: a tile, or a refusal that would be repeated. Poses of moving objects are not
  /// noted, because they are needed again in every loop of the animation.
  void note(const TileNeed& need, std::int64_t now_us);
  /// Removes the needs that have been answered. `stands`: the eye is and stays where it was.
  /// Answers that came before the eye moved count for kForgetUs.
  void remove_from(std::vector<TileNeed>& needs, bool stands, std::int64_t now_us);

  static constexpr std::int64_t kForgetUs = 2'000'000;

 private:
  /// Instance, light, channels, size class, view level, cell x and y, distance level and index.
  using Key = std::tuple<std::uint32_t, std::uint32_t, std::uint8_t, std::uint8_t, std::uint8_t,
                         std::uint16_t, std::uint16_t, std::uint8_t, std::int32_t>;
  static Key key_of(const TileNeed& need);

  struct Answer {
    std::int64_t came_us = 0;
    bool moved = false;  ///< the eye has moved since
  };
  std::map<Key, Answer> answers_;
};

}  // namespace mirage
