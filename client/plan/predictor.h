#pragma once
// Predictor: predicts the view from a damped velocity, gated (numerics.md section 4).
// Input:  view samples in order of time.
// Output: the view expected later, and its measured error.
// Thread: the frame loop's.
// Full:   never; it keeps a fixed state.

#include <cstdint>
#include <deque>
#include <vector>

#include "protocol/impostor/camera.h"

namespace mirage {

/// Quantiles of the prediction's error, measured when the predicted time has come.
struct PredictionError {
  double p50_m = 0, p95_m = 0, p50_degrees = 0, p95_degrees = 0;
};

class Predictor {
 public:
  /// `max_speed_mps`: a faster change of position counts as a jump and restarts the state.
  explicit Predictor(double max_speed_mps) : max_speed_(max_speed_mps) {}

  /// Takes a view sample. Drops samples with NaN or with a time that does not rise. Merges a sample
  /// within 100 µs of the last. Restarts after a pause above 150 ms, and at a jump.
  void add(std::int64_t time_us, const Pose& pose);
  /// Returns the pose expected `horizon_us` after the last sample.
  Pose predict(std::int64_t horizon_us) const;
  /// Remembers a prediction, to compare it with the pose at that time.
  void remember(std::int64_t horizon_us);
  const glm::dvec3& velocity_mps() const { return velocity_; }
  PredictionError error() const;
  /// Returns false until two samples have given a velocity, and right after a jump.
  bool has_velocity() const { return has_velocity_; }

 private:
  struct Remembered {
    std::int64_t due_us;
    Pose pose;
  };
  void restart(std::int64_t time_us, const Pose& pose);
  void judge(std::int64_t time_us, const Pose& pose);

  double max_speed_;
  bool started_ = false;
  bool has_velocity_ = false;
  std::int64_t time_us_ = 0;
  Pose pose_;
  glm::dvec3 velocity_{0};  ///< m/s
  glm::dvec3 spin_{0};      ///< rad/s, world axis times rate
  std::deque<Remembered> remembered_;
  std::vector<float> errors_m_;
  std::vector<float> errors_degrees_;
};

}  // namespace mirage
