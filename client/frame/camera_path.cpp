#include "client/frame/camera_path.h"

#include <algorithm>
#include <cmath>
#include <fstream>
#include <optional>
#include <sstream>

#include "protocol/base/stable_math.h"
#include "protocol/model/animation.h"

namespace mirage {
namespace {

constexpr double kTau = 6.283185307179586;
constexpr double kDegree = kTau / 360.0;
constexpr std::size_t kMaxTraceLines = 10'000'000;

glm::dvec3 horizontal(const glm::dvec3& v) {
  const glm::dvec3 flat = safe_normalize({v.x, 0, v.z});
  return flat == glm::dvec3(0) ? glm::dvec3(0, 0, -1) : flat;
}

glm::dvec3 turned(const glm::dvec3& v, double yaw) {
  const double c = std::cos(yaw), s = std::sin(yaw);
  return {c * v.x + s * v.z, v.y, -s * v.x + c * v.z};
}

Pose looking(const glm::dvec3& eye, const glm::dvec3& direction) {
  return look_at(eye, eye + direction);
}

}  // namespace

Result<CameraPath> CameraPath::create(const std::string& spec, const HomeView& home,
                                      const glm::dvec3& scene_center, double scene_radius) {
  CameraPath path;
  path.home_ = home;
  path.center_ = scene_center;
  path.radius_ = scene_radius;
  const std::pair<const char*, Kind> names[] = {
      {"still", Kind::kStill},      {"orbit", Kind::kOrbit}, {"walk", Kind::kWalk},
      {"fly", Kind::kFly},          {"shake", Kind::kShake}, {"strafe", Kind::kStrafe},
      {"teleport", Kind::kTeleport}};
  if (spec.rfind("builtin:", 0) == 0) {
    for (const auto& [name, kind] : names) {
      if (spec.substr(8) == name) {
        path.kind_ = kind;
        return path;
      }
    }
    return make_error(ErrorId::kUsage, "unknown path '" + spec + "'",
                      "builtin:still, orbit, walk, fly, shake, strafe or teleport");
  }
  if (const std::size_t hash = spec.find("#eye="); hash != std::string::npos) {
    Result<Key> view = read_view(spec.substr(hash + 1));
    if (!view) return view.error();
    path.kind_ = Kind::kTrace;
    path.keys_ = {view.take()};
    return path;
  }
  Result<std::vector<Key>> keys = read_trace(spec);
  if (!keys) return keys.error();
  path.kind_ = Kind::kTrace;
  path.keys_ = keys.take();
  return path;
}

std::optional<Pose> CameraPath::start_of(const std::string& spec) {
  if (spec.empty() || spec.rfind("builtin:", 0) == 0) return std::nullopt;
  const Result<CameraPath> path = create(spec, {}, glm::dvec3(0), 1);
  return path ? std::optional<Pose>(path->at(0)) : std::nullopt;
}

Result<CameraPath::Key> CameraPath::read_view(const std::string& fragment) {
  std::istringstream parts(fragment);
  std::optional<glm::dvec3> eye, look;
  for (std::string part; std::getline(parts, part, '&');) {
    const bool is_eye = part.rfind("eye=", 0) == 0;
    if (!is_eye && part.rfind("look=", 0) != 0) continue;
    std::string text = part.substr(part.find('=') + 1);
    std::replace(text.begin(), text.end(), ',', ' ');
    std::istringstream in(text);
    glm::dvec3 at(0);
    if ((in >> at.x >> at.y >> at.z) && std::isfinite(at.x + at.y + at.z))
      (is_eye ? eye : look) = at;
  }
  if (eye && look && *eye != *look) return Key{0, look_at(*eye, *look)};
  return make_error(ErrorId::kUsage, "'#" + fragment + "' is no view",
                    "#eye=X,Y,Z&look=X,Y,Z, two points apart, as a browser's address has them");
}

Result<std::vector<CameraPath::Key>> CameraPath::read_trace(const std::string& path) {
  std::ifstream file(path);
  if (!file) return make_error(ErrorId::kIo, "cannot read path file '" + path + "'");
  std::vector<Key> keys;
  std::string line;
  for (std::size_t number = 1; std::getline(file, line); ++number) {
    if (line.empty() || line[0] == '#' || line == "\r") continue;
    std::istringstream in(line);
    double v[7];
    bool ok = true;
    for (double& value : v) ok = ok && (in >> value) && std::isfinite(value);
    ok = ok && (keys.empty() || v[6] / 1000.0 >= keys.back().seconds);
    if (!ok || keys.size() >= kMaxTraceLines) {
      return make_error(ErrorId::kUsage,
                        path + ":" + std::to_string(number) + ": not a line of the path format",
                        "x y z rx ry rz t_ms: metres, degrees, milliseconds, time not falling");
    }
    const glm::dvec3 angles = glm::dvec3(v[3], v[4], v[5]) * kDegree;
    keys.push_back(
        {v[6] / 1000.0, {{v[0], v[1], v[2]}, glm::quat(glm::normalize(glm::dquat(angles)))}});
  }
  if (keys.empty()) return make_error(ErrorId::kUsage, "path file '" + path + "' has no lines");
  return keys;
}

Pose CameraPath::walk(double seconds) const {
  // The loop that every built-in scene keeps free: a circle through the home eye, turning right.
  const glm::dvec3 forward = horizontal(home_.target - home_.eye);
  const glm::dvec3 right(-forward.z, 0, forward.x);
  const double angle = seconds * home_.walk_speed_mps / home_.walk_radius_m;
  const double bob = 0.01 * home_.walk_speed_mps * std::sin(kTau * 1.8 * seconds);
  const glm::dvec3 eye = home_.eye + right * (home_.walk_radius_m * one_minus_cos(angle)) +
                         forward * (home_.walk_radius_m * std::sin(angle)) + glm::dvec3(0, bob, 0);
  const double pitch_y =
      (home_.target - home_.eye).y / std::max(glm::length(home_.target - home_.eye), 1e-9);
  const double yaw = 20 * kDegree * std::sin(kTau * seconds / 6.0);
  glm::dvec3 direction = turned(forward, -angle - yaw);
  direction.y = pitch_y;
  return looking(eye, direction);
}

Pose CameraPath::trace(double seconds) const {
  const auto after = std::upper_bound(keys_.begin(), keys_.end(), seconds,
                                      [](double t, const Key& k) { return t < k.seconds; });
  if (after == keys_.begin()) return keys_.front().pose;
  if (after == keys_.end()) return keys_.back().pose;
  const Key& a = *(after - 1);
  const Key& b = *after;
  const double t = b.seconds > a.seconds ? (seconds - a.seconds) / (b.seconds - a.seconds) : 1.0;
  return {glm::mix(a.pose.eye, b.pose.eye, t),
          glm::quat(slerp_shortest(a.pose.rotation, b.pose.rotation, t))};
}

Pose CameraPath::at(double seconds) const {
  const glm::dvec3 view = home_.target - home_.eye;
  const glm::dvec3 forward = horizontal(view);
  const glm::dvec3 right(-forward.z, 0, forward.x);
  switch (kind_) {
    case Kind::kStill:
      return look_at(home_.eye, home_.target);
    case Kind::kOrbit: {
      const glm::dvec3 offset = turned(home_.eye - home_.target, 30 * kDegree * seconds);
      return look_at(home_.target + offset, home_.target);
    }
    case Kind::kWalk:
      return walk(seconds);
    case Kind::kFly: {
      const double speed = 2.5 * home_.walk_speed_mps;
      const double turn = std::max(0.6 * radius_, 2.0 * home_.walk_radius_m);
      const double a = seconds * speed / turn;
      const glm::dvec3 eye = home_.eye + forward * (turn * std::sin(a)) +
                             right * (turn * one_minus_cos(a)) +
                             glm::dvec3(0, 0.15 * radius_ * one_minus_cos(a), 0);
      return looking(eye, turned(forward, -a) - glm::dvec3(0, 0.15, 0));
    }
    case Kind::kShake: {
      // 200 degrees a second at the peak: amplitude 20 degrees at 1.6 Hz.
      const double yaw = 20 * kDegree * std::sin(kTau * 1.6 * seconds);
      return looking(home_.eye, turned(view, yaw));
    }
    case Kind::kStrafe: {
      const double side = 0.5 * home_.walk_radius_m * std::sin(kTau * seconds / 4.0);
      return looking(home_.eye + right * side, view);
    }
    case Kind::kTeleport: {
      const double hop = std::floor(seconds);
      return walk(hop * 7.0);
    }
    case Kind::kTrace:
      return trace(seconds);
  }
  return {};
}

}  // namespace mirage
