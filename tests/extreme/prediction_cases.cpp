// P1 to P9: the predictor, its gate, and what a still head costs.

#include <cmath>
#include <limits>
#include <random>

#include "client/plan/predictor.h"
#include "protocol/base/stable_math.h"
#include "tests/extreme/registry.h"
#include "tests/extreme/shapes.h"
#include "tests/support/rig.h"

namespace mirage::extreme {
using namespace test;
namespace {

constexpr double kTimeNan = std::numeric_limits<double>::quiet_NaN();
constexpr double kTimeInf = std::numeric_limits<double>::infinity();
constexpr double kMaxSpeed = 50;  // m/s
constexpr std::int64_t kPredictedFrameUs = 16'667;
constexpr double kDegrees = 57.29577951308232;

Pose turned(const glm::dvec3& eye, double yaw, const glm::dvec3& axis = {0, 1, 0}) {
  return {eye, glm::quat(glm::angleAxis(yaw, glm::normalize(axis)))};
}

double angle(const glm::quat& a, const glm::quat& b) {
  const glm::dquat d = glm::dquat(a) * glm::conjugate(glm::dquat(b));
  return 2 * std::atan2(glm::length(glm::dvec3(d.x, d.y, d.z)), std::abs(d.w));
}

// Returns how far the value is from a pose: infinite if it is not finite, otherwise the rotation's
// error in length.
double off_pose(const Pose& p) {
  const glm::dquat q(p.rotation);
  const double off = std::abs(glm::length(q) - 1);
  return is_finite(p.eye) && std::isfinite(off) ? off : kTimeInf;
}

/// Walks for a second at `speed` along x while turning at `yaw_rate`. Returns the time of the last
/// sample.
std::int64_t walk(Predictor& predictor, double speed, double yaw_rate = 0) {
  std::int64_t t = 0;
  for (int i = 0; i < 60; ++i) {
    t = i * kPredictedFrameUs;
    const double s = static_cast<double>(t) * 1e-6;
    predictor.add(t, turned({speed * s, 1.7, 0}, yaw_rate * s));
  }
  return t;
}

// P1: dt 0 is dropped. 1e-9 s, which rounds to the same or the next microsecond, is dropped or
// merged, and gives no velocity.
Outcome no_time(const Conditions& conditions) {
  Random random(conditions.seed);
  double moved_by_zero = 0, change_of_speed = 0, off = 0;
  for (int i = 0; i < conditions.count(2'000); ++i) {
    Predictor predictor(kMaxSpeed);
    const std::int64_t t = walk(predictor, 1.4, 0.5);
    const Pose before = predictor.predict(100'000);
    const double speed = glm::length(predictor.velocity_mps());
    const glm::dvec3 noise = random.direction() * random.log_uniform(1e-6, 1);
    const Pose here = predictor.predict(0);
    predictor.add(t, turned(here.eye + noise, random.uniform(-3, 3)));
    moved_by_zero =
        std::max(moved_by_zero, glm::length(predictor.predict(100'000).eye - before.eye));
    // A clock of nanoseconds cut to microseconds gives 0 or 1 us for 1e-9 s.
    predictor.add(t + 1, turned(here.eye + noise, random.uniform(-3, 3)));
    change_of_speed =
        std::max(change_of_speed, std::abs(glm::length(predictor.velocity_mps()) - speed));
    off = std::max(off, off_pose(predictor.predict(400'000)));
  }
  Checks checks;
  checks.equal("moved by a sample of dt 0, m", moved_by_zero, 0);
  checks.equal("change of speed by dt 1e-9, m/s", change_of_speed, 0);
  checks.at_most("rotation off unit length", off, 1e-6);
  return checks.outcome();
}

// P2: after ten seconds without a sample nothing of the old motion is left.
Outcome long_pause(const Conditions&) {
  double moved = 0;
  for (const double speed : {0.1, 1.4, 49.0}) {
    for (const std::int64_t pause : {std::int64_t{10'000'000}, std::int64_t{150'001}}) {
      Predictor predictor(kMaxSpeed);
      const std::int64_t t = walk(predictor, speed, 2.0);
      const Pose there = turned({20 * speed, 1.7, 3}, 1);
      predictor.add(t + pause, there);
      for (const std::int64_t h : {1'000, 100'000, 1'000'000}) {
        const Pose p = predictor.predict(h);
        moved =
            std::max({moved, glm::length(p.eye - there.eye), angle(p.rotation, there.rotation)});
      }
    }
  }
  // The motion that follows is tracked again.
  Predictor predictor(kMaxSpeed);
  const std::int64_t t = walk(predictor, 1.4);
  for (int i = 0; i < 30; ++i) {
    predictor.add(t + 10'000'000 + i * kPredictedFrameUs, turned({0, 1.7, 0.02 * i}, 0));
  }
  const double speed = 0.02 / (1e-6 * static_cast<double>(kPredictedFrameUs));
  Checks checks;
  checks.at_most("moved from the new sample, m or rad", moved, 1e-6);
  checks.at_most("speed half a second later, off by, m/s",
                 std::abs(glm::length(predictor.velocity_mps()) - speed), 1e-6);
  return checks.outcome();
}

// P3: a teleport is a jump, not a speed.
Outcome teleport(const Conditions& conditions) {
  Random random(conditions.seed);
  double past = 0, beyond = 0, off = 0;
  for (int i = 0; i < conditions.count(2'000); ++i) {
    Predictor predictor(kMaxSpeed);
    const std::int64_t t = walk(predictor, random.log_uniform(0.01, 40), random.uniform(-5, 5));
    const glm::dvec3 there = random.direction() * 1e6;
    predictor.add(t + kPredictedFrameUs, turned(there, random.uniform(-3, 3)));
    for (const std::int64_t h : {1'000, 100'000, 1'000'000}) {
      past = std::max(past, glm::length(predictor.predict(h).eye - there));
    }
    // The frames after it never move more than the largest speed allows.
    glm::dvec3 eye = there;
    for (int k = 2; k < 12; ++k) {
      eye += random.direction() * 0.03;
      predictor.add(t + k * kPredictedFrameUs, turned(eye, random.uniform(-3, 3)));
      for (const std::int64_t h : {1'000, 100'000, 1'000'000}) {
        const Pose p = predictor.predict(h);
        const double most = kMaxSpeed * static_cast<double>(h) * 1e-6;
        beyond = std::max(beyond, glm::length(p.eye - eye) - most);
        off = std::max(off, off_pose(p));
      }
    }
  }
  Checks checks;
  checks.equal("predicted away from where it jumped to, m", past, 0);
  checks.at_most("moved beyond v_max h, m", beyond, 1e-6);
  checks.at_most("rotation off unit length", off, 1e-6);
  return checks.outcome();
}

// P4
Outcome no_rotation(const Conditions&) {
  int changed = 0;
  double off = 0, kept = 0;
  const float nan = static_cast<float>(kTimeNan), inf = static_cast<float>(kTimeInf);
  Predictor predictor(kMaxSpeed);
  const std::int64_t t = walk(predictor, 1.4, 0.5);
  const Pose before = predictor.predict(100'000);
  std::int64_t now = t;
  for (const glm::quat& q :
       {glm::quat(0, 0, 0, 0), glm::quat(-0.0f, 0, 0, 0), glm::quat(1e-20f, 0, 0, 1e-20f),
        glm::quat(nan, 0, 0, 0), glm::quat(1, nan, 0, 0), glm::quat(nan, nan, nan, nan),
        glm::quat(inf, 0, 0, 0), glm::quat(0, -inf, 0, 1)}) {
    predictor.add(now += 500, {{1, 1, 1}, q});
    const Pose after = predictor.predict(100'000);
    changed += before.eye == after.eye && before.rotation == after.rotation ? 0 : 1;
    off = std::max(off, off_pose(after));
  }
  // The first sample is bad: the result is still a pose.
  Predictor fresh(kMaxSpeed);
  fresh.add(0, {{kTimeNan, 0, 0}, glm::quat(1, 0, 0, 0)});
  fresh.add(1, {{1, 1, 1}, glm::quat(0, 0, 0, 0)});
  off = std::max(off, off_pose(fresh.predict(100'000)));
  // A rotation of any length is taken, as a unit one.
  predictor.add(now += kPredictedFrameUs, {before.eye, glm::quat(3e3f, 0, 4e3f, 0)});
  kept = angle(predictor.predict(0).rotation, glm::quat(0.6f, 0, 0.8f, 0));
  off = std::max(off, off_pose(predictor.predict(100'000)));
  Checks checks;
  checks.equal("predictions changed", changed, 0);
  checks.at_most("rotation off unit length", off, 1e-6);
  checks.at_most("a long quaternion off by, rad", kept, 1e-5);
  return checks.outcome();
}

// P5
Outcome signs(const Conditions& conditions) {
  Random random(conditions.seed);
  int differing = 0;
  for (int run = 0; run < conditions.count(200); ++run) {
    Predictor plain(kMaxSpeed), flipped(kMaxSpeed);
    const glm::dvec3 axis = random.direction();
    const double rate = random.uniform(0, 12);
    for (int i = 0; i < 60; ++i) {
      const double s = 1e-6 * static_cast<double>(i * kPredictedFrameUs);
      Pose pose = turned({1.4 * s, 0, 0}, rate * s, axis);
      plain.add(i * kPredictedFrameUs, pose);
      if (random.uniform(0, 1) < 0.5) pose.rotation = -pose.rotation;
      flipped.add(i * kPredictedFrameUs, pose);
      const Pose a = plain.predict(200'000), b = flipped.predict(200'000);
      const bool same = a.eye == b.eye && (a.rotation == b.rotation || a.rotation == -b.rotation);
      differing += same ? 0 : 1;
    }
  }
  Checks checks;
  checks.equal("outputs that differ", differing, 0);
  return checks.outcome();
}

// P6: half a turn between two samples, where the shorter way is not defined.
Outcome half_turn(const Conditions& conditions) {
  Random random(conditions.seed);
  double off = 0, turned_by = 0;
  const double pi = 3.14159265358979323846;
  const auto try_turn = [&](const glm::dvec3& axis, double turn) {
    Predictor predictor(kMaxSpeed);
    predictor.add(0, turned({0, 0, 0}, 0));
    predictor.add(kPredictedFrameUs, turned({0, 0, 0}, turn, axis));
    for (const std::int64_t h : {1'000, 16'667, 500'000}) {
      const Pose p = predictor.predict(h);
      off = std::max(off, off_pose(p));
      turned_by = std::max(turned_by, angle(p.rotation, predictor.predict(0).rotation));
    }
  };
  for (int i = 0; i < conditions.count(2'000); ++i) {
    const glm::dvec3 axis = random.direction();
    try_turn(axis, pi);
    try_turn(axis, pi + random.log_uniform(1e-16, 1e-3));
    try_turn(axis, pi - random.log_uniform(1e-16, 1e-3));
    try_turn(axis, random.log_uniform(1e-12, 1e-5));
  }
  Checks checks;
  checks.at_most("rotation off unit length, or not finite", off, 1e-6);
  checks.at_most("turned by, rad", turned_by, pi + 1e-6);
  return checks.outcome();
}

// P7: a fast turn of the head: 500 degrees a second, then a stop.
Outcome fast_turn(const Conditions&) {
  const double rate = 500 / kDegrees;
  Predictor predictor(kMaxSpeed);
  const std::int64_t t = walk(predictor, 0, rate);
  double off = 0, wrong = 0;
  for (const double h : {0.02, 0.05, 0.1, 0.2}) {
    const Pose p = predictor.predict(std::llround(h * 1e6));
    off = std::max(off, off_pose(p));
    // The turn is expected to die down with T = 0.4 s.
    const double yaw = rate * (static_cast<double>(t) * 1e-6 - 0.4 * std::expm1(-h / 0.4));
    wrong = std::max(wrong, angle(p.rotation, turned({}, yaw).rotation) * kDegrees);
  }
  const Pose stopped = predictor.predict(0);
  for (int i = 1; i <= 12; ++i) predictor.add(t + i * kPredictedFrameUs, stopped);
  const double after = angle(predictor.predict(200'000).rotation, stopped.rotation) * kDegrees;
  // An eye that only turns does not move, however it turns.
  const double moved = glm::length(predictor.predict(400'000).eye - stopped.eye);
  Checks checks;
  checks.at_most("rotation off unit length", off, 1e-6);
  checks.at_most("off the damped turn, degrees", wrong, 0.01);
  checks.at_most("still turning 0.2 s after the stop, degrees", after, 0.01);
  checks.equal("moved, m", moved, 0);
  return checks.outcome();
}

// P8: the whole client for an hour at 60 Hz, with a head that only trembles.
Outcome still_hour(const Conditions& conditions) {
  RigScene scene;
  scene.objects = 12;
  RigOptions options;
  options.net.rtt_ms = 50;
  options.net.server_ms = 5;
  Rig rig(rig_scene(scene), options);
  std::mt19937_64 random(conditions.seed);
  std::normal_distribution<double> noise(0, 1e-4);
  const Pose still = eye_at({0, 0, 4}, {0, 0, -4});
  const auto trembling = [&](double) {
    Pose pose = still;
    pose.eye += glm::dvec3(noise(random), noise(random), noise(random));
    return pose;
  };
  rig.run(10, trembling);
  const std::uint64_t asked = rig.session.tiles().asked, batches = rig.server_link.batches();
  const DrawList list = rig.run(3600, trembling);
  Checks checks;
  checks.equal("requests", static_cast<double>(rig.session.tiles().asked - asked), 0);
  checks.equal("messages sent", static_cast<double>(rig.server_link.batches() - batches), 0);
  checks.at_least("tiles held before", static_cast<double>(asked), 12);
  checks.equal("drawn of those in view", static_cast<double>(list.impostors.size()),
               static_cast<double>(list.visible));
  return checks.outcome();
}

// P9: the smoothing gain and the damped motion over sixteen decades of w dt.
Outcome any_rate(const Conditions& conditions) {
  Random random(conditions.seed);
  double least_step = kTimeInf, out_of_range = 0, worst = 0, last = -1;
  const int count = conditions.count(200'000);
  for (int i = 0; i <= count; ++i) {
    const double x = 1e-8 * std::pow(1e16, static_cast<double>(i) / count);
    const double gain = smoothing_gain(x);
    least_step = std::min(least_step, gain - last);
    out_of_range = std::max({out_of_range, -gain, gain - 1});
    const long double exact = -std::expm1(-static_cast<long double>(x));
    worst = std::max(worst, static_cast<double>(std::abs((gain - exact) / exact)));
    last = gain;
  }
  // The eye's predicted way grows with the horizon, and is never longer than v T.
  int falls = 0, too_far = 0;
  for (int i = 0; i < conditions.count(1'000); ++i) {
    Predictor predictor(kMaxSpeed);
    const double speed = random.log_uniform(1e-6, 40);
    walk(predictor, speed);
    const glm::dvec3 here = predictor.predict(0).eye;
    double before = 0;
    for (std::int64_t h = 1; h <= 100'000'000'000'000; h *= 10) {  // us: w h from 1e-6 to 1e8
      const double way = glm::length(predictor.predict(h).eye - here);
      falls += way >= before ? 0 : 1;
      too_far += way <= speed * 0.8 * (1 + 1e-6) + 1e-9 ? 0 : 1;
      before = way;
    }
  }
  Checks checks;
  checks.at_least("least step of the gain", least_step, 0);
  checks.at_most("outside 0 to 1 by", out_of_range, 0);
  checks.at_most("relative error of the gain", worst, 1e-15);
  checks.equal("ways that shrink with the horizon", falls, 0);
  checks.equal("ways beyond v T", too_far, 0);
  return checks.outcome();
}

}  // namespace

std::vector<Case> prediction_cases() {
  return {
      {"P1", "view samples with dt 0 and 1e-9 s", "dropped or merged: no velocity", no_time},
      {"P2", "view samples with dt 10 s", "state restarts, the old motion is gone", long_pause},
      {"P3", "teleport of 1e6 m", "restarts there; displacement <= v_max h", teleport},
      {"P4", "NaN and zero quaternions", "dropped, prediction unchanged", no_rotation},
      {"P5", "q and -q", "same output", signs},
      {"P6", "rotation by pi between samples", "finite unit rotation, at most half a turn",
       half_turn},
      {"P7", "head turning at 500 degrees/s", "follows the damped turn, stops with it", fast_turn},
      {"P8", "still head with 0.1 mm noise for 1 h", "0 requests", still_hour, 400},
      {"P9", "smoothing and damping with w dt from 1e-8 to 1e8", "monotone", any_rate},
  };
}

}  // namespace mirage::extreme
