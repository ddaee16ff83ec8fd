#include "client/plan/predictor.h"

#include <algorithm>
#include <cmath>

#include "protocol/base/quantile.h"
#include "protocol/base/stable_math.h"

namespace mirage {
namespace {

constexpr double kVelocityTau = 0.015;  // s, smoothing of the velocity
constexpr double kPositionDecay = 0.8;  // s, how long a motion is expected to last
constexpr double kRotationDecay = 0.4;
constexpr std::int64_t kMergeUs = 100;
constexpr std::int64_t kPauseUs = 150'000;
constexpr std::size_t kMaxRemembered = 256;
constexpr double kDegrees = 57.29577951308232;

bool usable(const Pose& pose) {
  const glm::quat& q = pose.rotation;
  const double n = double{q.w} * q.w + double{q.x} * q.x + double{q.y} * q.y + double{q.z} * q.z;
  return is_finite(pose.eye) && std::isfinite(n) && n > 1e-12;
}

// Returns the rotation vector of a unit quaternion, the shorter way round (q and -q agree). Near
// zero it uses the series.
glm::dvec3 log_rotation(glm::dquat q) {
  if (q.w < 0) q = -q;
  const glm::dvec3 v(q.x, q.y, q.z);
  const double s = glm::length(v);
  if (s < 1e-6) return 2.0 * v;
  return v * (2.0 * std::atan2(s, q.w) / s);
}

glm::dquat exp_rotation(const glm::dvec3& r) {
  const double angle = glm::length(r);
  if (angle < 1e-9) return glm::normalize(glm::dquat(1, 0.5 * r.x, 0.5 * r.y, 0.5 * r.z));
  const glm::dvec3 axis = r / angle;
  const double s = std::sin(0.5 * angle);
  return {std::cos(0.5 * angle), s * axis.x, s * axis.y, s * axis.z};
}

}  // namespace

void Predictor::restart(std::int64_t time_us, const Pose& pose) {
  started_ = true;
  has_velocity_ = false;
  time_us_ = time_us;
  pose_ = pose;
  velocity_ = spin_ = glm::dvec3(0);
  remembered_.clear();
}

void Predictor::add(std::int64_t time_us, const Pose& sample) {
  if (!usable(sample)) return;
  Pose pose = sample;
  pose.rotation = glm::quat(glm::normalize(glm::dquat(sample.rotation)));
  if (!started_) return restart(time_us, pose);
  const std::int64_t dt_us = time_us - time_us_;
  if (dt_us <= 0) return;
  if (dt_us < kMergeUs) {
    pose_ = pose;
    return;
  }
  const double dt = static_cast<double>(dt_us) * 1e-6;
  const glm::dvec3 velocity = (pose.eye - pose_.eye) / dt;
  if (dt_us > kPauseUs || glm::length(velocity) > max_speed_) return restart(time_us, pose);
  const glm::dquat turn = glm::dquat(pose.rotation) * glm::conjugate(glm::dquat(pose_.rotation));
  const double gain = has_velocity_ ? smoothing_gain(dt / kVelocityTau) : 1.0;
  velocity_ += gain * (velocity - velocity_);
  spin_ += gain * (log_rotation(turn) / dt - spin_);
  has_velocity_ = true;
  time_us_ = time_us;
  pose_ = pose;
  judge(time_us, pose);
}

Pose Predictor::predict(std::int64_t horizon_us) const {
  if (!has_velocity_ || horizon_us <= 0) return pose_;
  const double h = static_cast<double>(horizon_us) * 1e-6;
  Pose out = pose_;
  glm::dvec3 step = velocity_ * (kPositionDecay * smoothing_gain(h / kPositionDecay));
  const double longest = max_speed_ * h, length = glm::length(step);
  if (length > longest) step *= longest / length;
  out.eye += step;
  const glm::dvec3 turn = spin_ * (kRotationDecay * smoothing_gain(h / kRotationDecay));
  out.rotation = glm::quat(glm::normalize(exp_rotation(turn) * glm::dquat(pose_.rotation)));
  return out;
}

void Predictor::remember(std::int64_t horizon_us) {
  if (!has_velocity_ || remembered_.size() >= kMaxRemembered) return;
  remembered_.push_back({time_us_ + horizon_us, predict(horizon_us)});
}

void Predictor::judge(std::int64_t time_us, const Pose& pose) {
  while (!remembered_.empty() && remembered_.front().due_us <= time_us) {
    const Pose& expected = remembered_.front().pose;
    const double error = glm::length(expected.eye - pose.eye);
    const glm::dquat turn =
        glm::dquat(pose.rotation) * glm::conjugate(glm::dquat(expected.rotation));
    errors_m_.push_back(static_cast<float>(error));
    errors_degrees_.push_back(static_cast<float>(glm::length(log_rotation(turn)) * kDegrees));
    remembered_.pop_front();
  }
}

PredictionError Predictor::error() const {
  return {quantile(errors_m_, 0.5), quantile(errors_m_, 0.95), quantile(errors_degrees_, 0.5),
          quantile(errors_degrees_, 0.95)};
}

}  // namespace mirage
