// V1 to V7: view vectors, keys, and where no impostor can be.

#include <cmath>
#include <limits>

#include "protocol/base/limits.h"
#include "protocol/base/stable_math.h"
#include "protocol/impostor/camera.h"
#include "protocol/impostor/error_bound.h"
#include "tests/extreme/registry.h"
#include "tests/extreme/shapes.h"
#include "tests/extreme/view_bound_cases.h"
#include "tests/support/core_scene.h"

namespace mirage::extreme {
namespace {

constexpr double kViewNan = std::numeric_limits<double>::quiet_NaN();
constexpr double kViewInf = std::numeric_limits<double>::infinity();

double off_orthonormal(const glm::dvec3& a, const glm::dvec3& b, const glm::dvec3& c) {
  double most = 0;
  for (const glm::dvec3& v : {a, b, c}) most = std::max(most, std::abs(glm::length(v) - 1));
  most = std::max(
      {most, std::abs(glm::dot(a, b)), std::abs(glm::dot(b, c)), std::abs(glm::dot(c, a))});
  // A frame of axes is right-handed with the third axis backwards; a mirrored one is wrong.
  const double side = glm::length(glm::cross(a, b) + c);
  return is_finite(a + b + c) ? std::max(most, side) : kViewInf;
}

// V1: axes of camera and capture that look along +-up, and within 1e-7 of it.
Outcome along_up(const Conditions& conditions) {
  Random random(conditions.seed);
  double camera_off = 0, capture_off = 0;
  const int count = conditions.count(20'000);
  for (int i = 0; i < count; ++i) {
    const double lean = i < 4 ? 0.0 : random.log_uniform(1e-30, 1e-7);
    const double side = i % 2 ? 1 : -1, turn = random.uniform(0, 6.2831853);
    const glm::dvec3 v(lean * std::cos(turn), side, lean * std::sin(turn));
    Camera camera;
    camera.pose = look_at({0, 0, 0}, v);
    camera_off =
        std::max(camera_off, off_orthonormal(camera.right(), camera.up(), camera.forward()));
    const CaptureBasis basis = capture_basis(*view_cell_from_direction(v, i % 17));
    capture_off = std::max(capture_off, off_orthonormal(basis.right, basis.up, basis.forward));
  }
  Checks checks;
  checks.at_most("camera frame off by", camera_off, 1e-6);
  checks.at_most("capture frame off by", capture_off, 1e-6);
  return checks.outcome();
}

// V2: the key refuses vectors without a direction. A client whose eye is at a centre, or nowhere,
// asks for nothing and draws no impostor.
Outcome no_direction(const Conditions&) {
  int accepted = 0, asks = 0, drawn = 0;
  for (const glm::dvec3& v :
       {glm::dvec3(0), glm::dvec3(-0.0), glm::dvec3(kViewNan, 0, 1), glm::dvec3(0, kViewNan, 0),
        glm::dvec3(1, 1, kViewNan), glm::dvec3(kViewNan), glm::dvec3(kViewInf, 0, 0),
        glm::dvec3(0, -kViewInf, 1)}) {
    for (int level = 0; level <= limits::kMaxViewLevel; ++level) {
      accepted += view_cell_from_direction(v, level) ? 1 : 0;
    }
    accepted +=
        distance_bucket_from_radii(glm::length(v) > 0 ? kViewNan : glm::length(v), 4) ? 1 : 0;
    test::SelectorWorld world(test::make_scene({{{0, 0, 0}}}));
    world.camera.pose.eye = v;
    asks += static_cast<int>(world.selector.needs(world.input()).size());
    drawn += static_cast<int>(world.select(world.input()).impostors.size());
  }
  Checks checks;
  checks.equal("keys made", accepted, 0);
  checks.equal("tiles asked for", asks, 0);
  checks.equal("impostors drawn", drawn, 0);
  return checks.outcome();
}

// V3
Outcome any_length(const Conditions& conditions) {
  Random random(conditions.seed);
  int differing = 0;
  const int count = conditions.count(100'000);
  for (int i = 0; i < count; ++i) {
    const glm::dvec3 v = random.direction();
    const int level = i % (limits::kMaxViewLevel + 1);
    const auto key = view_cell_from_direction(v, level);
    // Powers of two keep the direction exactly.
    for (const double length : {std::exp2(-66), std::exp2(66), std::exp2(-1000), std::exp2(1000)}) {
      differing += view_cell_from_direction(v * length, level) == key ? 0 : 1;
    }
    for (const double length : {1e-20, 1e20}) {
      // Decimal lengths round each component, so only a vector on a border may change cells.
      const auto scaled = view_cell_from_direction(v * length, level);
      const auto again = view_cell_from_direction(direction_from_view_cell(*key) * length, level);
      differing += again == key && scaled ? 0 : 1;
    }
  }
  Checks checks;
  checks.equal("keys that differ", differing, 0);
  return checks.outcome();
}

// V4: a tile seen from the opposite side, by every method.
Outcome opposite(const Conditions& conditions) {
  Random random(conditions.seed);
  int infinite = 0, fresh = 0;
  double least = kViewInf;
  const int count = conditions.count(20'000);
  for (int i = 0; i < count; ++i) {
    test::SelectorWorld world(test::make_scene({{{0, 0, 0}}}));
    const glm::dvec3 axis = random.direction();
    world.look(axis * random.log_uniform(1.3, 1e3), {0, 0, 0});
    const TileRecordPtr tile = world.add_tile(0);
    const double distance = random.log_uniform(1.3, 1e3);
    const glm::dvec3 from =
        direction_from_view_cell(*view_cell_from_direction(tile->capture.eye(), 16));
    world.look(from * -distance, {0, 0, 0});
    world.camera.fov_y = random.log_uniform(1e-3, 1);
    const ViewGeometry view =
        view_geometry(world.camera, world.scene.instances[0], world.scene.objects[0]);
    if (radius_px(view) < 1) continue;  // too small for an error to show
    for (const DrawMethod method : {DrawMethod::kQuad, DrawMethod::kDepth}) {
      const double bound = tile->bound_px(method, world.scene.objects[0], view);
      infinite += std::isfinite(bound) ? 0 : 1;
      fresh += is_stale(bound, 1.0) ? 0 : 1;
      least = std::min(least, bound);
    }
  }
  Checks checks;
  checks.equal("bounds that are not finite", infinite, 0);
  checks.equal("taken as good", fresh, 0);
  checks.at_least("least bound, px", least, 1.0);
  return checks.outcome();
}

// V5: the folds and corners of the octahedral map, its axes with zeros of both signs, and random
// places.
Outcome folds(const Conditions& conditions) {
  Random random(conditions.seed);
  const int count = conditions.count(1'000'000);
  int differing = 0;
  constexpr double kCorners[] = {0.0, -0.0, 1.0, -1.0};
  const auto corner = [&] { return kCorners[static_cast<int>(random.uniform(0, 4))]; };
  for (int i = 0; i < count; ++i) {
    glm::dvec3 v = random.direction();
    const double tiny = random.log_uniform(1e-18, 0.1);
    if (i % 6 < 3) v[i % 3] *= tiny;
    if (i % 6 == 3) v = {tiny * v.x, v.y < 0 ? -1 : 1, tiny * v.z};
    if (i % 6 == 4) v = {corner(), i % 4 < 2 ? 1 : -1, corner()};
    const int level = i / 6 % (limits::kMaxViewLevel + 1);
    const auto cell = view_cell_from_direction(v, level);
    if (!cell || !valid(*cell)) {
      ++differing;
      continue;
    }
    differing += view_cell_from_direction(direction_from_view_cell(*cell), level) == *cell ? 0 : 1;
  }
  Checks checks;
  checks.equal("keys that do not come back", differing, 0);
  return checks.outcome();
}

// V6: there is no bound, and the client draws and asks for no impostor although it holds a tile.
Outcome inside(const Conditions&) {
  int finite = 0, impostors = 0, outside_finite = 0, outside_drawn = 0;
  const auto try_at = [](double distance, int& bounds, int& used) {
    test::SelectorWorld world(test::make_scene({{{0, 0, 0}}}));
    world.look({0.3, 0.2, 5}, {0, 0, 0});
    const TileRecordPtr tile = world.add_tile(0);
    world.camera.pose.eye = glm::normalize(glm::dvec3(0.3, 0.2, 5)) * distance;
    const ViewGeometry view =
        view_geometry(world.camera, world.scene.instances[0], world.scene.objects[0]);
    for (const DrawMethod method : {DrawMethod::kQuad, DrawMethod::kCuboid, DrawMethod::kHull,
                                    DrawMethod::kWarp, DrawMethod::kDepth}) {
      bounds += std::isfinite(tile->bound_px(method, world.scene.objects[0], view)) ? 1 : 0;
    }
    used += static_cast<int>(world.select(world.input()).impostors.size() +
                             world.selector.needs(world.input()).size());
  };
  for (const double distance : {0.0, 1e-30, 0.5, 1.0, 1.0 + 1e-7}) {
    try_at(distance, finite, impostors);
  }
  try_at(4.9, outside_finite, outside_drawn);  // outside there is one
  Checks checks;
  checks.equal("finite bounds", finite, 0);
  checks.equal("impostors drawn or asked for", impostors, 0);
  checks.at_least("from outside: finite bounds", outside_finite, 2);
  checks.at_least("from outside: drawn", outside_drawn, 1);
  return checks.outcome();
}

// V7: a million million radii away; captured at the farthest possible distance, 1e6 r.
Outcome far_away(const Conditions& conditions) {
  Random random(conditions.seed);
  const int count = conditions.count(20'000);
  int bad = 0, violations = 0;
  for (int i = 0; i < count; ++i) {
    const double r = random.log_uniform(1e-3, 1e3), distance = 1e12 * r;
    const glm::dvec3 axis = random.direction();
    const auto cell = view_cell_from_direction(axis * distance, limits::kMaxViewLevel);
    const auto bucket = distance_bucket_from_radii(distance / r, i % 17);
    if (!cell || !bucket || !valid(*cell) || !valid(*bucket)) {
      ++bad;
      continue;
    }
    const Capture capture(*cell, *bucket, r, 64);
    ViewGeometry view;
    view.eye = axis * distance;
    view.radius = r;
    view.focal_px = random.log_uniform(1e3, 1e13);  // up to a telescope that fills the picture
    view.forward = -axis;
    view.center_depth = distance;
    const DrawnDepth drawn{r, r, 0, 0, 0, 0};
    const double bound = position_bound_px(view, capture.geometry(), drawn);
    bad +=
        std::isfinite(bound) && std::isfinite(texel_size_px(view, capture.geometry(), 64)) ? 0 : 1;
    // A point of the sphere, drawn as far off along its capture ray as allowed.
    const glm::dvec3 p = random.direction() * r;
    const double z = capture.depth(p), dc = capture.distance;
    const double shown = 1 / (1 / z - r / (dc * dc));
    const glm::dvec3 q = capture.eye() + (p - capture.eye()) * (shown / z);
    // Relative to the centre, because at this distance the eye's place alone needs more digits than
    // a double has.
    const glm::dvec3 right = safe_normalize(glm::cross(axis, random.direction()));
    const glm::dvec3 up = glm::cross(right, view.forward), step = q - p;
    const double zp = distance + glm::dot(p, view.forward);
    const double zq = distance + glm::dot(q, view.forward);
    const auto shift = [&](const glm::dvec3& side) {
      return (glm::dot(step, side) * zp - glm::dot(p, side) * glm::dot(step, view.forward)) /
             (zp * zq);
    };
    const double error = view.focal_px * std::hypot(shift(right), shift(up));
    violations += error <= bound * (1 + 1e-6) + 1e-6 ? 0 : 1;
  }
  Checks checks;
  checks.equal("keys or bounds not usable", bad, 0);
  checks.equal("errors above the bound", violations, 0);
  return checks.outcome();
}

}  // namespace

std::vector<Case> view_cases() {
  std::vector<Case> cases = {
      {"V1", "view along +-up, and within 1e-7 of it", "frames orthonormal to 1e-6", along_up},
      {"V2", "view vector 0, NaN, infinite; eye at the centre",
       "refused: no key, nothing asked for", no_direction},
      {"V3", "view vectors of length 1e-20 and 1e20", "same key", any_length},
      {"V4", "seen from the opposite side (theta = pi)", "finite bound, stale", opposite},
      {"V5", "1e6 directions over folds and corners of the octahedral map",
       "encode of decode = key", folds},
      {"V6", "eye at the centre, inside, at D = r and r (1 + 1e-7)", "bound +inf, no impostor",
       inside},
      {"V7", "D = 1e12 r", "valid key, finite bound, error within it", far_away},
  };
  for (const Case& one : view_bound_cases()) cases.push_back(one);
  return cases;
}

}  // namespace mirage::extreme
