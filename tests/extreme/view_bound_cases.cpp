#include "tests/extreme/view_bound_cases.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "client/draw/frame_target.h"
#include "client/draw/geometric_error.h"
#include "client/frame/planned_frame.h"
#include "protocol/base/stable_math.h"
#include "server/render/gpu_scene.h"
#include "tests/extreme/shapes.h"
#include "tests/extreme/studio.h"
#include "tests/support/process.h"

namespace mirage::extreme {
namespace {

constexpr double kBoundInf = std::numeric_limits<double>::infinity();

int exit_of_view(const std::string& url, const std::vector<std::string>& options) {
  std::vector<std::string> command = {test::binary("mirage-view"), url, "--frames", "2"};
  command.insert(command.end(), options.begin(), options.end());
  return test::run(command, 60).exit_code;
}

// V8: drawn right at the ends of the range, and refused by the shipped client beyond it.
Outcome fields_of_view(const Conditions& conditions) {
  Checks checks;
  Result<std::unique_ptr<Studio>> studio =
      Studio::create(write(document(dented_ball()), conditions.folder, "ball"));
  if (!studio) {
    checks.failed(studio.error().line());
    return checks.outcome();
  }
  for (const double degrees : {0.01, 170.0}) {
    const double fov = degrees * 0.017453292519943295;
    // The distance at which it fills the picture; at 170 degrees as near as an impostor may be.
    const double radii = std::max(1.0 / std::sin(0.45 * fov), 2.0);
    Camera camera = (*studio)->camera(0, {0.4, 0.3, 1}, radii, degrees > 90 ? 512 : 128);
    camera.fov_y = fov;
    const ReferenceFrame truth = (*studio)->truth(camera, 2);
    GeometricError error;
    // The offset is half a sample from the middle: there a 2x2 reference takes its depth.
    add_geometric_error(
        truth, 0.75,
        {camera, &(*studio)->scene(), (*studio)->impostor_list(camera, DrawMethod::kDepth), {}},
        error);
    const auto worst = std::max_element(error.errors_px.begin(), error.errors_px.end());
    const std::string at = number_text(degrees) + " degrees: ";
    checks.at_least(at + "pixels compared", static_cast<double>(error.compared), 300);
    checks.at_most(at + "worst error, px",
                   worst == error.errors_px.end() ? kBoundInf : static_cast<double>(*worst), 0.5);
  }
  int refused = 0;
  for (const char* fov : {"179", "180", "0", "nan"}) {
    // The option is refused before a connection is tried; nobody listens there.
    refused += exit_of_view("ws://127.0.0.1:1", {"--offscreen", "16x16", "--fov", fov}) == 2;
  }
  checks.equal("of 179, 180, 0, NaN refused", refused, 4);
  return checks.outcome();
}

// V9: the shipped client on the shipped server.
Outcome viewports(const Conditions& conditions) {
  Checks checks;
  const test::Server server(write(document(dented_ball()), conditions.folder, "ball"));
  if (!server.ready()) {
    checks.failed("no server");
    return checks.outcome();
  }
  const auto exit_at = [&](const char* size) {
    return exit_of_view(server.url(), {"--offscreen", size, "--virtual-time", "--msaa", "0"});
  };
  checks.equal("0x0 refused with", exit_at("0x0"), 2);
  checks.equal("1x1 ends with", exit_at("1x1"), 0);
  checks.equal("1x16384 ends with", exit_at("1x16384"), 0);
  checks.equal("16384x16384 refused with", exit_at("16384x16384"), 2);
  return checks.outcome();
}

// V10: the same scene at the origin and at 1e9 m. The eye's offsets are multiples of 2^-20 m, which
// a double at 1e9 m still holds. So any difference is the program's.
Outcome far_from_origin(const Conditions& conditions) {
  Checks checks;
  const glm::dvec3 offset(1e9, -1e9, 1e9);
  test::Builder near = document(dented_ball()), far = near;
  far.doc["nodes"][0]["translation"] = {offset.x, offset.y, offset.z};
  Result<std::unique_ptr<Studio>> a = Studio::create(write(near, conditions.folder, "near"));
  Result<std::unique_ptr<Studio>> b = Studio::create(write(far, conditions.folder, "far"));
  if (!a || !b) {
    checks.failed("the scene does not load");
    return checks.outcome();
  }
  Random random(conditions.seed);
  double worst = 0;
  for (int i = 0; i < conditions.count(10'000); ++i) {
    Camera camera;
    const glm::dvec3 eye = glm::round(random.direction() * 3.0 * 1048576.0) / 1048576.0;
    camera.pose = look_at(eye, {0, 0, 0});
    Camera there = camera;
    there.pose.eye += offset;
    const auto center = [](Studio& s, const Camera& c) {
      // The position that a shader gets: relative to the eye, as float.
      const InstanceView& view = s.scene().instances[0];
      const gl::MeshInstance data = gl::mesh_instance(view.world_from_object, c.pose.eye, 0);
      return c.pixel_from_relative(glm::dvec3(glm::vec3(data.position_scale)));
    };
    const glm::dvec3 p = center(**a, camera), q = center(**b, there);
    worst = std::max(worst, std::hypot(p.x - q.x, p.y - q.y));
  }
  checks.at_most("largest shift, px", worst, 1e-5);
  Camera camera;
  camera.width = camera.height = 128;
  camera.pose = look_at({1, 0.5, 3}, {0, 0, 0});
  camera.fit_depth_range({0, 0, 0}, 1.2);
  Camera there = camera;
  there.pose.eye += offset;
  checks.equal("truth differs by",
               largest_difference((*a)->truth(camera).rgba, (*b)->truth(there).rgba), 0);
  checks.equal("geometry differs by", largest_difference((*a)->meshes(camera), (*b)->meshes(there)),
               0);
  checks.equal("impostor differs by",
               largest_difference((*a)->impostors(camera, DrawMethod::kDepth),
                                  (*b)->impostors(there, DrawMethod::kDepth)),
               0);
  return checks.outcome();
}

// V11
Outcome monotone(const Conditions& conditions) {
  Random random(conditions.seed);
  int falls = 0, zeros = 0;
  double worst_slope = 0, worst_term = 0;
  for (int i = 0; i < conditions.count(1000); ++i) {
    const double radii = random.log_uniform(1.3, 1e4);
    CaptureGeometry capture;
    capture.axis = random.direction();
    capture.distance = radii;
    const glm::dvec3 side = safe_normalize(glm::cross(capture.axis, random.direction()));
    const double dz = random.log_uniform(1e-4, 1);
    const DrawnDepth drawn{dz, 1, 0, 0, 0, 0};
    double last = 0, last_term = 0, first_slope = 0;
    for (double theta = 1e-12; theta < 1; theta *= 1.5) {
      ViewGeometry view;
      view.radius = 1;
      view.focal_px = 1000;
      view.eye =
          radii * (capture.axis - capture.axis * one_minus_cos(theta) + side * std::sin(theta));
      view.forward = -safe_normalize(view.eye);
      view.center_depth = radii;
      const double bound = position_bound_px(view, capture, drawn);
      const double term = baseline_term(radii, radii, theta, 1);
      falls += bound >= last && term >= last_term ? 0 : 1;
      zeros += bound > 0 && term > 0 ? 0 : 1;
      // numerics.md section 2, B1 with D = Dc: radii (sin theta + 2 sin^2(theta/2) r / w), r = 1.
      const double half = std::sin(theta / 2), w = std::sqrt((radii - 1) * (radii + 1));
      const double exact = radii * (std::sin(theta) + 2 * half * half / w);
      worst_term = std::max(worst_term, std::abs(term / exact - 1));
      if (first_slope == 0) first_slope = bound / theta;
      // The bound is proportional to small angles, without steps of rounding.
      if (theta < 1e-6) {
        worst_slope = std::max(worst_slope, std::abs(bound / theta / first_slope - 1));
      }
      last = bound;
      last_term = term;
    }
  }
  Checks checks;
  checks.equal("steps down", falls, 0);
  checks.equal("zero bounds", zeros, 0);
  checks.at_most("slope below 1e-6 rad changes by", worst_slope, 1e-2);
  checks.at_most("baseline term off by, share of it", worst_term, 1e-14);
  return checks.outcome();
}

// V12: a point anywhere in the sphere, drawn anywhere on its capture ray that the tile's measure
// allows, and seen by any camera.
Outcome sound(const Conditions& conditions) {
  Random random(conditions.seed);
  const int count = conditions.count(1'000'000);
  int violations = 0, finite = 0;
  double tightest = 0;
  for (int i = 0; i < count; ++i) {
    const double r = random.log_uniform(1e-3, 1e3);
    const Capture capture(*view_cell_from_direction(random.direction(), 7),
                          *distance_bucket_from_radii(random.log_uniform(1.25, 100), 6), r, 64);
    const glm::dvec3 to_eye = glm::normalize(glm::normalize(capture.eye()) +
                                             random.direction() * random.log_uniform(1e-9, 1));
    ViewGeometry view;
    view.eye = to_eye * (r * random.log_uniform(1.2, 1e4));
    view.radius = r;
    view.focal_px = random.log_uniform(10, 5000);
    view.forward = glm::normalize(-to_eye + random.direction() * random.uniform(0, 0.5));
    view.center_depth = glm::dot(-view.eye, view.forward);
    const glm::dvec3 right = safe_normalize(glm::cross(view.forward, random.direction()));
    const glm::dvec3 p = random.direction() * (r * std::cbrt(random.uniform(0, 1)));
    const double zp = capture.depth(p), dc = capture.distance;
    const double z =
        std::max(zp + r * random.log_uniform(1e-4, 2) * random.uniform(-1, 1), 1e-3 * r);
    const glm::dvec3 q = capture.eye() + (p - capture.eye()) * (z / zp);
    const DrawnDepth drawn{
        dc * dc * std::abs(1 / zp - 1 / z), std::max(r, glm::length(q)), 0, 0, 0, 0};
    const double bound = position_bound_px(view, capture.geometry(), drawn);
    if (!(bound < kBoundInf)) continue;
    ++finite;
    const double error = point_error_px(view.focal_px, p - view.eye, q - view.eye, view.forward,
                                        right, glm::cross(right, view.forward));
    violations += error <= bound * (1 + 1e-9) + 1e-9 ? 0 : 1;
    tightest = std::max(tightest, error / bound);
  }
  Checks checks;
  checks.equal("errors above the bound", violations, 0);
  checks.at_least("share with a bound", static_cast<double>(finite) / count, 0.7);
  checks.at_least("largest error over bound", tightest, 0.5);
  return checks.outcome();
}

}  // namespace

std::vector<Case> view_bound_cases() {
  return {
      {"V8", "field of view 0.01 and 170 degrees; 179, 180, 0, NaN",
       "within 1/2 px of the reference; refused", fields_of_view},
      {"V9", "viewport 0x0, 1x1, 1x16384", "runs, or is refused in words", viewports},
      {"V10", "eye and scene at 1e9 m", "shifted by <= 1e-5 px", far_from_origin},
      {"V11", "view angle from 1e-12 to 1 rad", "bound monotone in it", monotone},
      {"V12", "1e6 random captures, views and points", "error <= bound", sound},
  };
}

}  // namespace mirage::extreme
