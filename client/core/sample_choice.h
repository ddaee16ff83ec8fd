#pragma once
// How many samples a pixel a viewer can afford, by what its frames take to draw.
//
// On a software renderer four samples take three to six times as long as one (forest walk, 640 x
// 360: 980 ms instead of 180 a frame, mean FLIP 0.049 instead of 0.064, the same bytes). They stay
// until frames are seen to be slow, whatever draws them.

namespace mirage {

class SampleChoice {
 public:
  static constexpr int kMost = 4;
  static constexpr double kSlowMs = 50;  ///< 20 frames a second

  /// `fixed`: as many, whatever frames take; below 0: as they allow. `slow_ms`: more than this is
  /// too long for a frame; 0: kSlowMs.
  explicit SampleChoice(int fixed, double slow_ms = 0)
      : samples_(fixed < 0 ? kMost : fixed),
        chooses_(fixed < 0),
        slow_ms_(slow_ms > 0 ? slow_ms : kSlowMs) {}

  /// A frame was drawn in `ms`. Whether samples() is another from now on. Slow ones in a row have
  /// to add up, as what is drawn for the first time takes long once; what is no number counts for
  /// nothing. It does not turn back: a frame that is quick with one sample need not be so with
  /// four.
  bool note_drawn(double ms);
  /// Of a pixel; 0: one, and no multisampling.
  int samples() const { return samples_; }

 private:
  int samples_;
  bool chooses_;
  double slow_ms_;
  double slow_in_a_row_ms_ = 0;
};

}  // namespace mirage
