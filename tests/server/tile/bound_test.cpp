// The bound from texels to pixels. Whatever a tile shows, measured by the server and drawn by the
// client with any method from anywhere, is within the bound; for plain, blended and cut objects.
#include <gtest/gtest.h>

#include <algorithm>
#include <random>

#include "client/hold/tile_cache.h"
#include "protocol/codec/tile_codec.h"
#include "protocol/impostor/error_bound.h"
#include "protocol/impostor/instance_group.h"
#include "server/tile/tile_measure.h"

namespace mirage::test {
namespace {

constexpr int kBoundEdge = 16;
constexpr int kTiles = 10'000;
constexpr int kViews = 10;
constexpr int kPoints = 10;

class Random {
 public:
  explicit Random(std::uint64_t seed) : random_(seed) {}
  double uniform(double low, double high) {
    return low + (high - low) * std::uniform_real_distribution<double>(0, 1)(random_);
  }
  double log_uniform(double low, double high) { return low * std::pow(high / low, uniform(0, 1)); }
  int below(int count) { return static_cast<int>(uniform(0, count)); }
  glm::dvec3 direction() {
    while (true) {
      const glm::dvec3 v(uniform(-1, 1), uniform(-1, 1), uniform(-1, 1));
      if (glm::length(v) > 1e-3 && glm::length(v) < 1) return glm::normalize(v);
    }
  }

 private:
  std::mt19937_64 random_;
};

/// Depths along the capture axis between which a ray is in the object's box; empty: low > high.
struct Span {
  double low = 0, high = -1;
};

Span in_box(const ObjectDescription& object, const Capture& capture, const glm::dvec2& texel) {
  const glm::dvec3 eye = capture.eye() + glm::dvec3(object.center);
  const glm::dvec3 u = capture.point_from_texel(texel, 1.0) - capture.eye();
  Span out{0, 1e300};
  for (int k = 0; k < 3; ++k) {
    double a = (double{object.box_min[k]} - eye[k]) / u[k];
    double b = (double{object.box_max[k]} - eye[k]) / u[k];
    if (a > b) std::swap(a, b);
    out.low = std::max(out.low, a);
    out.high = std::min(out.high, b);
  }
  return out;
}

/// Random texels within a random box: a picture that an object in that box could have.
struct Shot {
  ObjectDescription object;
  Capture capture;
  std::vector<std::uint8_t> rgba, depth, surface;
  TileRecord record;

  /// Capture depth of a code anywhere within its step.
  double depth_of(double code) const {
    const DepthCode& d = record.depth_code;
    const double u = std::clamp((code - 1) / 254, 0.0, 1.0);
    return d.near_depth * d.far_depth / (d.far_depth - u * (d.far_depth - d.near_depth));
  }
};

Shot random_shot(Random& random, bool blended) {
  Shot shot;
  GroupBounds bounds;
  const double size = random.log_uniform(1e-3, 1e3);
  bounds.half =
      glm::vec3(size * glm::dvec3(random.log_uniform(0.01, 1), random.log_uniform(0.01, 1),
                                  random.log_uniform(0.01, 1)));
  bounds.needs = blended ? NeedMask{kNeedBlend} : NeedMask{0};
  shot.object = group_description(bounds);
  shot.object.group = false;
  const auto radii = distance_bucket_from_radii(random.log_uniform(1.25, 60), 6);
  shot.capture = Capture(*view_cell_from_direction(random.direction(), 7), *radii,
                         double{shot.object.radius}, kBoundEdge);
  shot.record.depth_code = DepthCode(shot.capture.radius, shot.capture.distance);
  constexpr std::size_t kTexels = kBoundEdge * kBoundEdge;
  shot.rgba.assign(4 * kTexels, 0);
  shot.depth.assign(kTexels, 0);
  shot.surface.assign(4 * kTexels, 0);
  for (int y = 0; y < kBoundEdge; ++y) {
    for (int x = 0; x < kBoundEdge; ++x) {
      // The rows of pages go up, those of texels down.
      const Span span = in_box(shot.object, shot.capture, {x + 0.5, y + 0.5});
      const auto first = static_cast<int>(shot.record.depth_code.encode(span.low)) + 1;
      const auto last = static_cast<int>(shot.record.depth_code.encode(span.high)) - 1;
      if (!(span.low < span.high) || first > last || random.uniform(0, 1) < 0.3) continue;
      const std::size_t i = static_cast<std::size_t>((kBoundEdge - 1 - y) * kBoundEdge + x);
      const int code = first + random.below(last - first + 1);
      shot.depth[i] = static_cast<std::uint8_t>(code);
      shot.rgba[4 * i + 3] = 255;
      if (blended) shot.surface[4 * i] = static_cast<std::uint8_t>(random.below(last - code + 1));
    }
  }
  const PageTexels page{shot.rgba.data(), shot.depth.data(),
                        blended ? shot.surface.data() : nullptr, kBoundEdge};
  const Tile tile = cut_tile(page, kLitTile, shot.capture, shot.object);
  shot.record.capture = shot.capture;
  shot.record.crop = tile.crop;
  shot.record.measure = tile.measure;
  shot.record.depth = tile.depth;
  shot.record.seal(shot.object);
  return shot;
}

ViewGeometry random_view(Random& random, const Shot& shot, glm::dvec3& right, glm::dvec3& up) {
  ViewGeometry view;
  view.radius = double{shot.object.radius};
  const glm::dvec3 to_eye = glm::normalize(glm::normalize(shot.capture.eye()) +
                                           random.direction() * random.log_uniform(1e-5, 1));
  view.eye = to_eye * (view.radius * random.log_uniform(1.2, 100));
  view.focal_px = random.log_uniform(10, 5000);
  view.forward = glm::normalize(-to_eye + random.direction() * random.uniform(0, 0.5));
  right = glm::normalize(glm::cross(view.forward, random.direction()));
  up = glm::cross(right, view.forward);
  view.center_depth = glm::dot(-view.eye, view.forward);
  return view;
}

/// Returns the depth along the capture axis at which the method draws the ray of a texel; 0:
/// nowhere.
double drawn_at(const Shot& shot, DrawMethod method, const glm::dvec2& texel, int code) {
  const glm::dvec3 eye = shot.capture.eye() + glm::dvec3(shot.object.center);
  const glm::dvec3 u = shot.capture.point_from_texel(texel, 1.0) - shot.capture.eye();
  switch (method) {
    case DrawMethod::kQuad:
      return shot.record.measure.plane_depth;
    case DrawMethod::kCuboid:
      return ray_entry(box_planes(shot.object.box_min, shot.object.box_max), eye, u);
    case DrawMethod::kHull:
      return ray_entry(shot.object.hull.planes(), eye, u);
    default:
      return shot.depth_of(code);
  }
}

struct Outcome {
  std::int64_t points = 0, over = 0;
  double tightest = 0;
};

Outcome hold_against_bound(bool blended, std::uint64_t seed) {
  Random random(seed);
  Outcome out;
  for (int t = 0; t < kTiles; ++t) {
    const Shot shot = random_shot(random, blended);
    const TileRecord& record = shot.record;
    if (record.crop.area() == 0) continue;
    for (int v = 0; v < kViews; ++v) {
      glm::dvec3 right, up;
      const ViewGeometry view = random_view(random, shot, right, up);
      for (int k = 0; k < kPoints; ++k) {
        const int x = random.below(static_cast<int>(record.crop.w));
        const int y = random.below(static_cast<int>(record.crop.h));
        const int code =
            record.depth[static_cast<std::size_t>(y) * record.crop.w + static_cast<std::size_t>(x)];
        if (code == 0) continue;
        const glm::dvec2 texel(record.crop.x + x + 0.5, record.crop.y + y + 0.5);
        const std::size_t page =
            static_cast<std::size_t>(kBoundEdge - 1 - record.crop.y - y) * kBoundEdge +
            record.crop.x + static_cast<std::size_t>(x);
        // A surface behind a blended one shows as well.
        const int behind = blended ? random.below(shot.surface[4 * page] + 1) : 0;
        const double z = shot.depth_of(code + behind + random.uniform(-0.5, 0.5));
        const glm::dvec3 p = shot.capture.point_from_texel(texel, z);
        for (const DrawMethod method :
             {DrawMethod::kQuad, DrawMethod::kCuboid, DrawMethod::kHull, DrawMethod::kDepth}) {
          const double bound = record.bound_px(method, shot.object, view);
          const double zq = drawn_at(shot, method, texel, code);
          if (!std::isfinite(bound) || !(zq > 0)) continue;
          const glm::dvec3 q = shot.capture.point_from_texel(texel, zq);
          const double error =
              point_error_px(view.focal_px, p - view.eye, q - view.eye, view.forward, right, up);
          ++out.points;
          out.over += !(error <= bound * (1 + 1e-6) + 1e-6);
          if (bound > 0) out.tightest = std::max(out.tightest, error / bound);
        }
      }
    }
  }
  return out;
}

TEST(ServerBound, HoldsForWhatIsSolid) {
  const Outcome out = hold_against_bound(false, 1);
  EXPECT_EQ(out.over, 0);
  EXPECT_GT(out.points, 1'000'000);
  EXPECT_GT(out.tightest, 0.5);
}

TEST(ServerBound, HoldsForWhatIsSeenThrough) {
  const Outcome out = hold_against_bound(true, 2);
  EXPECT_EQ(out.over, 0);
  EXPECT_GT(out.points, 1'000'000);
  EXPECT_GT(out.tightest, 0.5);
}

}  // namespace
}  // namespace mirage::test
