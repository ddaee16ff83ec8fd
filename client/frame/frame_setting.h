#pragma once

namespace mirage {

/// The setting of a whole frame.
struct FrameSetting {
  int samples = 1;   ///< samples of a pixel
  double scale = 1;  ///< edge of the drawn picture over that of the shown one
  bool operator==(const FrameSetting& o) const { return samples == o.samples && scale == o.scale; }
};

}  // namespace mirage
