// D1 to D5: ranges of depth, ties, codes, edges, the near plane.

#include <algorithm>
#include <cmath>

#include "client/draw/frame_target.h"
#include "protocol/base/limits.h"
#include "protocol/base/stable_math.h"
#include "server/render/gpu_scene.h"
#include "tests/extreme/registry.h"
#include "tests/extreme/shapes.h"
#include "tests/extreme/studio.h"

namespace mirage::extreme {
namespace {

using nlohmann::json;
constexpr int kDepthSize = 96;

/// A square of half width 1 facing +z, with a material of one colour, unlit.
int add_card(test::Builder& builder, const json& color) {
  const int position = builder.vec3({-1, -1, 0, 1, -1, 0, 1, 1, 0, -1, 1, 0});
  const int index = builder.indices({0, 1, 2, 0, 2, 3});
  builder.doc["extensionsUsed"] = {"KHR_materials_unlit"};
  builder.doc["materials"].push_back({{"pbrMetallicRoughness", {{"baseColorFactor", color}}},
                                      {"extensions", {{"KHR_materials_unlit", json::object()}}}});
  builder.doc["meshes"].push_back(
      {{"primitives", json::array({{{"attributes", {{"POSITION", position}}},
                                    {"indices", index},
                                    {"material", builder.doc["materials"].size() - 1}}})}});
  return static_cast<int>(builder.doc["meshes"].size()) - 1;
}

void place(test::Builder& builder, int mesh, const glm::dvec3& at, double scale) {
  builder.doc["nodes"].push_back(
      {{"mesh", mesh}, {"translation", {at.x, at.y, at.z}}, {"scale", {scale, scale, scale}}});
}

struct Shares {
  int red = 0, green = 0;
};

Shares count(const Pixels& p) {
  Shares out;
  for (std::size_t i = 0; i < p.size(); i += 4) {
    if (p[i + 3] != 255) continue;
    if (p[i] > 128 && p[i + 1] < 64) ++out.red;
    if (p[i + 1] > 128 && p[i] < 64) ++out.green;
  }
  return out;
}

/// One picture from 1 mm to 1e9 m: at each decade a red card just before a green one, each pair
/// beside the others. The green one is a quarter larger, and must show only around the red one.
struct Decades {
  std::unique_ptr<Studio> studio;
  Camera camera;
  double red = 0, green = 0;  ///< pixels if all is in order
  double range = 0;

  static Result<Decades> create(const std::string& folder, double gap) {
    test::Builder builder;
    const int red = add_card(builder, {1, 0, 0, 1}), green = add_card(builder, {0, 1, 0, 1});
    double z = 1e-3;
    int pairs = 0;
    for (; z < 1.5e9; z *= 10, ++pairs) {
      const double x = (pairs % 4 - 1.5) * 0.22 * z, y = (pairs / 4 - 1.5) * 0.22 * z;
      place(builder, red, {x, y, -z}, 0.08 * z);
      place(builder, green, {x * (1 + gap), y * (1 + gap), -z * (1 + gap)}, 0.1 * z * (1 + gap));
    }
    Result<std::unique_ptr<Studio>> studio =
        Studio::create(write(builder, folder, "cards" + number_text(gap)));
    if (!studio) return studio.error();
    Decades out;
    out.studio = studio.take();
    out.camera.width = out.camera.height = 256;
    out.camera.fov_y = 0.9;
    out.camera.pose = look_at({0, 0, 0}, {0, 0, -1});
    out.camera.fit_depth_range(out.studio->scene().bounds_center,
                               out.studio->scene().bounds_radius);
    const double side = 2 * 0.08 * out.camera.focal_px();
    out.red = pairs * side * side;
    out.green = out.red * (1.25 * 1.25 - 1);
    out.range = z / 10 / 1e-3;
    return out;
  }
  void check(Checks& checks, const std::string& name, const Pixels& p) const {
    const Shares shares = count(p);
    checks.at_least(name + ": red, of what there is", shares.red / red, 0.9);
    checks.at_least(name + ": green, of what there is", shares.green / green, 0.8);
  }
};

// D1: impostors hold 8 bits of depth over their own size, so their pairs are farther apart.
Outcome far_and_near(const Conditions& conditions) {
  Checks checks;
  Result<Decades> close = Decades::create(conditions.folder, 1e-6);
  Result<Decades> apart = Decades::create(conditions.folder, 0.02);
  if (!close || !apart) return no_studio((close ? apart : close).error());
  checks.at_least("far over near", close->range, 0.99e12);
  close->check(checks, "truth", close->studio->truth(close->camera).rgba);
  close->check(checks, "geometry", close->studio->meshes(close->camera));
  apart->check(checks, "quads", apart->studio->impostors(apart->camera, DrawMethod::kQuad));
  apart->check(checks, "relief", apart->studio->impostors(apart->camera, DrawMethod::kDepth));
  return checks.outcome();
}

// D2: two cards at one place, red first; the same one is seen from everywhere, all of it.
Outcome ties(const Conditions& conditions) {
  test::Builder builder;
  const int red = add_card(builder, {1, 0, 0, 1}), green = add_card(builder, {0, 1, 0, 1});
  place(builder, red, {0, 0, 0}, 1);
  place(builder, green, {0, 0, 0}, 1);
  Result<std::unique_ptr<Studio>> studio =
      Studio::create(write(builder, conditions.folder, "cards"));
  if (!studio) return no_studio(studio.error());
  Random random(conditions.seed);
  int mixed[3] = {}, winners[3][2] = {}, unequal = 0;
  const int views = conditions.quick ? 6 : 40;
  for (int i = 0; i < views; ++i) {
    const glm::dvec3 direction =
        glm::normalize(glm::dvec3(random.uniform(-0.7, 0.7), random.uniform(-0.7, 0.7), 1));
    const Camera camera = (*studio)->camera(0, direction, random.uniform(2, 20), kDepthSize);
    // One list of tiles is drawn twice: a tile's place in the atlas must not change the picture.
    const DrawList list = (*studio)->impostor_list(camera, DrawMethod::kQuad);
    const auto take = [&](int kind) {
      return kind == 0   ? (*studio)->truth(camera).rgba
             : kind == 1 ? (*studio)->meshes(camera)
                         : (*studio)->draw(camera, list);
    };
    for (int kind = 0; kind < 3; ++kind) {
      const Pixels first = take(kind);
      unequal += first == take(kind) ? 0 : 1;
      const Shares shares = count(first);
      mixed[kind] += std::min(shares.red, shares.green);
      ++winners[kind][shares.red > shares.green ? 0 : 1];
    }
  }
  Checks checks;
  const char* names[] = {"truth", "geometry", "impostors"};
  for (int kind = 0; kind < 3; ++kind) {
    checks.equal(names[kind] + std::string(": pixels of the other card"), mixed[kind], 0);
    checks.equal(names[kind] + std::string(": views with the other winner"),
                 std::min(winners[kind][0], winners[kind][1]), 0);
  }
  checks.equal("pictures that differ when drawn again", unequal, 0);
  return checks.outcome();
}

// D3: the tile's own code of 8 bits, and linear codes of 8, 16 and 24 bits over [-r, r].
Outcome coded_depth(const Conditions& conditions) {
  Random random(conditions.seed);
  Checks checks;
  const int tries = conditions.count(200'000);
  for (const int bits : {0, 8, 16, 24}) {
    int violations = 0, finite = 0;
    double tightest = 0;
    for (int i = 0; i < tries; ++i) {
      const double r = random.log_uniform(1e-3, 1e3);
      const Capture capture(*view_cell_from_direction(random.direction(), 9),
                            *distance_bucket_from_radii(random.log_uniform(1.25, 1e3), 6), r, 64);
      ViewGeometry view;
      const glm::dvec3 to_eye = glm::normalize(glm::normalize(capture.eye()) +
                                               random.direction() * random.log_uniform(1e-4, 0.5));
      view.eye = to_eye * (r * random.log_uniform(1.25, 1e3));
      view.radius = r;
      view.focal_px = random.log_uniform(100, 4000);
      view.forward = -to_eye;
      view.center_depth = glm::length(view.eye);
      const glm::dvec3 p = random.direction() * (r * std::cbrt(random.uniform(0, 1)));
      const double z = capture.depth(p), dc = capture.distance;
      double shown = 0, dz = 0;
      if (bits == 0) {
        const DepthCode code(r, dc);
        shown = code.decode(code.encode(z));
        dz = dc * dc * code.inverse_quantum();
      } else {
        const double steps = std::exp2(bits) - 1, step = 2 * r / steps;
        shown = dc - r + std::round((z - dc + r) / step) * step;
        // Half a step of depth, at the nearest depth of the sphere.
        dz = 0.5 * step * (dc / (dc - r)) * (dc / (dc - r - 0.5 * step));
      }
      const DrawnDepth drawn{dz, r * 1.0001 + 2 * r / 255, 0, 0, 0, 0};
      const double bound = position_bound_px(view, capture.geometry(), drawn);
      if (!std::isfinite(bound)) continue;
      ++finite;
      const glm::dvec3 q = capture.eye() + (p - capture.eye()) * (shown / z);
      const glm::dvec3 right = safe_normalize(glm::cross(view.forward, random.direction()));
      const double error = point_error_px(view.focal_px, p - view.eye, q - view.eye, view.forward,
                                          right, glm::cross(right, view.forward));
      // The rounding of the reference itself, px at this focal length, is allowed.
      violations += error <= bound * (1 + 1e-6) + 1e-9 ? 0 : 1;
      tightest = std::max(tightest, error / bound);
    }
    const std::string name = bits == 0 ? "tile code" : std::to_string(bits) + " bits";
    checks.equal(name + ": errors above the bound", violations, 0);
    checks.at_least(name + ": share with a bound", static_cast<double>(finite) / tries, 0.5);
    checks.at_least(name + ": largest error over bound", tightest, 0.3);
  }
  return checks.outcome();
}

// D4: a small red card before a large green one, as one object. Its tile from the front is seen
// from aside, with stored depth. A pixel that has neither card's colour, or is outside what either
// covers, is a surface stretched over the step.
Outcome no_rubber_sheet(const Conditions& conditions) {
  test::Builder builder;
  const int red = add_card(builder, {1, 0, 0, 1});
  const int green = add_card(builder, {0, 1, 0, 1});
  // One mesh of two primitives, the red one nearer and smaller.
  json& primitives = builder.doc["meshes"][green]["primitives"];
  json small = builder.doc["meshes"][red]["primitives"][0];
  small["attributes"]["POSITION"] =
      builder.vec3({-0.4f, -0.4f, 0.5f, 0.4f, -0.4f, 0.5f, 0.4f, 0.4f, 0.5f, -0.4f, 0.4f, 0.5f});
  primitives.push_back(small);
  place(builder, green, {0, 0, 0}, 1);
  Result<std::unique_ptr<Studio>> studio =
      Studio::create(write(builder, conditions.folder, "step"));
  if (!studio) return no_studio(studio.error());
  const Camera front = (*studio)->camera(0, {0, 0, 1}, 5, kDepthSize);
  const DrawList list = (*studio)->impostor_list(front, DrawMethod::kDepth);
  double mixed = 0, outside = 0, lost = 0;
  for (const double degrees : {2.0, 5.0, 10.0, 20.0}) {
    const double a = degrees * 0.017453292519943295;
    const Camera aside =
        (*studio)->camera(0, {std::sin(a), 0.3 * std::sin(a), std::cos(a)}, 5, kDepthSize);
    const Pixels drawn = (*studio)->draw(aside, list), truth = (*studio)->truth(aside).rgba;
    int between = 0, beyond = 0, missing = 0;
    const auto solid = [&](const Pixels& p, int x, int y) {
      return x >= 0 && y >= 0 && x < kDepthSize && y < kDepthSize &&
             p[static_cast<std::size_t>((y * kDepthSize + x) * 4 + 3)] > 8;
    };
    for (int y = 0; y < kDepthSize; ++y) {
      for (int x = 0; x < kDepthSize; ++x) {
        const std::size_t i = static_cast<std::size_t>((y * kDepthSize + x) * 4);
        bool near_truth = false;
        for (int n = 0; n < 25; ++n)
          near_truth = near_truth || solid(truth, x + n % 5 - 2, y + n / 5 - 2);
        if (drawn[i + 3] > 64 && !near_truth) ++beyond;
        if (truth[i + 3] == 255 && drawn[i + 3] < 128) ++missing;
        const bool both = drawn[i] > 70 && drawn[i + 1] > 70 && drawn[i + 3] > 250;
        between += both ? 1 : 0;
      }
    }
    // The outline of the red card, a texel wide on either side, is mixed in any picture.
    mixed = std::max(
        mixed, between / (4 * 0.8 * front.focal_px() / 5 / (*studio)->scene().instances[0].radius));
    outside = std::max(outside, static_cast<double>(beyond));
    lost = std::max(lost, static_cast<double>(missing));
  }
  Checks checks;
  checks.at_most("mixed px, per px of the step's outline", mixed, 1.5);
  checks.equal("px more than 2 px outside the truth", outside, 0);
  checks.at_most("px missing", lost, 0.02 * kDepthSize * kDepthSize);
  return checks.outcome();
}

// D5: the near plane cuts the object, as geometry, and through every proxy.
Outcome cut_by_near_plane(const Conditions& conditions) {
  test::Builder builder = document(dented_ball());
  set_material(builder, {{"doubleSided", true}});  // a cut object shows its inside
  Result<std::unique_ptr<Studio>> studio =
      Studio::create(write(builder, conditions.folder, "ball"));
  if (!studio) return no_studio(studio.error());
  Checks checks;
  int bad = 0;
  for (const double share : {0.2, 0.5, 0.7}) {
    Camera camera = (*studio)->camera(0, {0.5, 0.4, 1}, 3, kDepthSize);
    const InstanceView& view = (*studio)->scene().instances[0];
    camera.near_m = 3 * view.radius - view.radius + 2 * share * view.radius;
    const Pixels truth = (*studio)->truth(camera).rgba, mesh = (*studio)->meshes(camera);
    int both = 0, any = 0;
    for (std::size_t i = 3; i < truth.size(); i += 4) {
      both += truth[i] >= 128 && mesh[i] >= 128 ? 1 : 0;
      any += truth[i] >= 128 || mesh[i] >= 128 ? 1 : 0;
    }
    const std::string at = number_text(100 * share) + " % cut: ";
    checks.at_least(at + "px of the truth", static_cast<double>(covered(truth)), 100);
    checks.at_least(at + "geometry's share of them",
                    any > 0 ? static_cast<double>(both) / any : 0.0, 0.95);
    for (const DrawMethod method : {DrawMethod::kQuad, DrawMethod::kCuboid, DrawMethod::kHull,
                                    DrawMethod::kWarp, DrawMethod::kDepth}) {
      bad += (*studio)->impostors(camera, method).empty() ? 1 : 0;
      bad += glGetError() == GL_NO_ERROR ? 0 : 1;
    }
  }
  checks.equal("pictures not drawn, GL errors", bad, 0);
  return checks.outcome();
}

}  // namespace

std::vector<Case> depth_cases() {
  return {
      {"D1", "far/near 1e12, surfaces a millionth apart", "order kept at gap 1e-6", far_and_near},
      {"D2", "two surfaces at equal depth", "stable order", ties},
      {"D3", "depth of 8, 16, 24 bits, and the tile's code", "within bound (c)", coded_depth},
      {"D4", "a step in depth, and background beside it", "no rubber sheet", no_rubber_sheet},
      {"D5", "near plane through the object", "drawn cut, finite, no error", cut_by_near_plane},
  };
}

}  // namespace mirage::extreme
