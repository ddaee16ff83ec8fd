#pragma once
// The clock of the animation, which a person may stop.

#include <cstdint>

namespace mirage {

class Playback {
 public:
  bool playing() const { return playing_; }
  /// Returns the time of the animation, s, at this time of the session.
  double at(std::int64_t now_us) const {
    return playing_ ? seconds(now_us) - behind_s_ : stopped_s_;
  }
  /// Stops the animation where it is, or lets it go on from there.
  void play(bool playing, std::int64_t now_us) {
    if (playing == playing_) return;
    if (playing) {
      behind_s_ = seconds(now_us) - stopped_s_;
    } else {
      stopped_s_ = at(now_us);
    }
    playing_ = playing;
  }

 private:
  static double seconds(std::int64_t us) { return static_cast<double>(us) * 1e-6; }

  bool playing_ = true;
  double behind_s_ = 0;   ///< how long it stood, in all
  double stopped_s_ = 0;  ///< where it stands
};

}  // namespace mirage
