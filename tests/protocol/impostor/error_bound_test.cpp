// The bound must hold for every point on every ray; where nothing can be promised it is +infinity.
#include "protocol/impostor/error_bound.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>
#include <vector>

#include "protocol/base/limits.h"
#include "protocol/base/stable_math.h"
#include "protocol/impostor/capture.h"

namespace mirage::test {
namespace {

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
constexpr double kInf = std::numeric_limits<double>::infinity();

/// A random capture and a random present view of one sphere.
struct Case {
  Capture capture;
  ViewGeometry view;
  glm::dvec3 forward, right, up;
};

class Cases {
 public:
  double uniform(double low, double high) {
    return low + (high - low) * std::uniform_real_distribution<double>(0, 1)(random_);
  }
  double log_uniform(double low, double high) { return low * std::pow(high / low, uniform(0, 1)); }
  glm::dvec3 direction() {
    while (true) {
      const glm::dvec3 v(uniform(-1, 1), uniform(-1, 1), uniform(-1, 1));
      if (glm::length(v) > 1e-3 && glm::length(v) < 1) return glm::normalize(v);
    }
  }
  Case next() {
    Case c;
    const double radius = log_uniform(1e-3, 1e3);
    const glm::dvec3 to_capture = direction();
    const auto bucket = distance_bucket_from_radii(log_uniform(1.25, 100), 6);
    c.capture = Capture(*view_cell_from_direction(to_capture, 7), *bucket, radius, 64);
    // The eye is anywhere, from a hair beside the capture eye on.
    const glm::dvec3 off = direction() * log_uniform(1e-6, 1);
    const glm::dvec3 to_eye = glm::normalize(glm::normalize(c.capture.eye()) + off);
    c.view.eye = to_eye * (radius * log_uniform(1.2, 100));
    c.view.focal_px = log_uniform(10, 5000);
    c.view.radius = radius;
    // The centre need not be in the middle of the picture, so the view is turned off it.
    c.forward = glm::normalize(-to_eye + direction() * uniform(0, 0.5));
    c.right = glm::normalize(glm::cross(c.forward, direction()));
    c.up = glm::cross(c.right, c.forward);
    c.view.center_depth = glm::dot(-c.view.eye, c.forward);
    c.view.forward = c.forward;
    return c;
  }

 private:
  std::mt19937_64 random_{5};
};

/// Returns the true error, px, of a random point in the sphere: its drawn twin is on the same
/// capture ray, at capture depth `z`.
double error_px(const Case& c, const glm::dvec3& p, double z) {
  const glm::dvec3 eye = c.capture.eye();
  const glm::dvec3 q = eye + (p - eye) * (z / c.capture.depth(p));
  return point_error_px(c.view.focal_px, p - c.view.eye, q - c.view.eye, c.forward, c.right, c.up);
}

// (a): every point is drawn on the plane through the centre, across the capture axis.
TEST(ProtocolErrorBound, SoundForTheQuadAtTheCentrePlane) {
  Cases cases;
  int finite = 0;
  double tightest = 0;
  for (int i = 0; i < 500'000; ++i) {
    const Case c = cases.next();
    const double r = c.view.radius, dc = c.capture.distance;
    DrawnDepth drawn;
    drawn.dz = dc * r / (dc - r);  // Dc^2 (1/(Dc - r) - 1/Dc)
    drawn.q = r * dc / tangent_length(dc, r);
    drawn.drawn_min = drawn.drawn_max = dc;
    const double bound = position_bound_px(c.view, c.capture.geometry(), drawn);
    if (!(bound < kInf)) continue;
    ++finite;
    for (int k = 0; k < 2; ++k) {
      const glm::dvec3 p = cases.direction() * (r * std::cbrt(cases.uniform(k, 1)));
      const double error = error_px(c, p, dc);
      ASSERT_LE(error, bound * (1 + 1e-9) + 1e-9) << "case " << i;
      tightest = std::max(tightest, error / bound);
    }
  }
  EXPECT_GT(finite, 375'000);
  EXPECT_GT(tightest, 0.5);  // and it is not too loose
}

// (b), (c): the drawn depth is off by at most dz, and stays within the bounding sphere.
TEST(ProtocolErrorBound, SoundForAnyDrawnDepth) {
  Cases cases;
  double tightest = 0;
  for (int i = 0; i < 500'000; ++i) {
    Case c = cases.next();
    if (i % 4 == 0) c.view.forward = glm::dvec3(0);  // unknown: looser, but sound
    const double r = c.view.radius;
    const double dz = r * cases.log_uniform(1e-4, 2);
    const glm::dvec3 p = cases.direction() * (r * std::cbrt(cases.uniform(0, 1)));
    const double zp = c.capture.depth(p);
    const double z = std::max(zp + dz * cases.uniform(-1, 1), 1e-3 * r);
    const glm::dvec3 eye = c.capture.eye();
    const double q = std::max(r, glm::length(eye + (p - eye) * (z / zp)));
    const double dc = c.capture.distance;
    DrawnDepth drawn;
    drawn.dz = dc * dc * std::abs(1 / zp - 1 / z);
    drawn.q = q;
    const double bound = position_bound_px(c.view, c.capture.geometry(), drawn);
    if (!(bound < kInf)) continue;
    const double error = error_px(c, p, z);
    ASSERT_LE(error, bound * (1 + 1e-9) + 1e-9) << "case " << i;
    tightest = std::max(tightest, error / bound);
  }
  EXPECT_GT(tightest, 0.5);
}

/// Content in a part of the window and of the depth, drawn on the plane at the harmonic mean.
struct Content {
  TileCrop crop;
  double low = 0, high = 0, plane = 0;
};

Content random_content(Cases& cases, const Case& c) {
  Content out;
  const auto span = [&](std::uint32_t& first, std::uint32_t& size) {
    first = static_cast<std::uint32_t>(cases.uniform(1, 40));
    size = static_cast<std::uint32_t>(cases.uniform(4, 63 - first));
  };
  span(out.crop.x, out.crop.w);
  span(out.crop.y, out.crop.h);
  const double a = cases.uniform(-1, 1), b = cases.uniform(-1, 1);
  out.low = c.capture.distance + c.view.radius * std::min(a, b);
  out.high = c.capture.distance + c.view.radius * std::max(a, b);
  out.plane = 2 * out.low * out.high / (out.low + out.high);
  return out;
}

DrawnDepth content_depth(const Case& c, const Content& content) {
  const double dc = c.capture.distance, r = c.view.radius, z = content.plane;
  DrawnDepth drawn;
  drawn.dz = 0.5 * dc * dc * (1 / content.low - 1 / content.high);
  drawn.q = std::hypot(z - dc, z * r / tangent_length(dc, r));
  drawn.surface_min = content.low;
  drawn.surface_max = content.high;
  drawn.drawn_min = drawn.drawn_max = z;
  return drawn;
}

// The measures of a tile make the bound tight: beyond 10 radii the largest error over the content
// comes near it.
TEST(ProtocolErrorBound, SoundAndTightForMeasuredContent) {
  Cases cases;
  std::vector<double> ratios;
  for (int i = 0; i < 20'000; ++i) {
    const Case c = cases.next();
    const Content content = random_content(cases, c);
    const double bound =
        position_bound_px(c.view, c.capture.geometry(content.crop), content_depth(c, content));
    if (!(bound < kInf)) continue;
    double worst = 0;
    for (int k = 0; k < 40; ++k) {
      const double z = k % 2 ? content.low : content.high;
      const glm::dvec2 texel(content.crop.x + content.crop.w * cases.uniform(0, 1),
                             content.crop.y + content.crop.h * cases.uniform(0, 1));
      const glm::dvec3 p = c.capture.point_from_texel(texel, z);
      if (glm::length(p) > c.view.radius) continue;
      worst = std::max(worst, error_px(c, p, content.plane));
    }
    ASSERT_LE(worst, bound * (1 + 1e-9) + 1e-9) << "case " << i;
    const bool far = glm::length(c.view.eye) > 10 * c.view.radius;
    if (far && c.capture.distance > 10 * c.view.radius && worst > 0)
      ratios.push_back(bound / worst);
  }
  ASSERT_GT(ratios.size(), 1000u);
  std::nth_element(ratios.begin(), ratios.begin() + std::ptrdiff_t(ratios.size() / 2),
                   ratios.end());
  EXPECT_LE(ratios[ratios.size() / 2], 1.2);
}

ViewGeometry plain_view() { return {500, 1, {0, 0, 4}, 4, 0, {0, 0, -1}}; }
const CaptureGeometry kPlainCapture{{0, 0, 1}, 3, {}, {}, {}, {}};
constexpr DrawnDepth kPlainDrawn{1, 1, 0, 0, 0, 0};

void expect_stale(const ViewGeometry& v, const CaptureGeometry& c, const DrawnDepth& d) {
  const double bound = position_bound_px(v, c, d);
  EXPECT_EQ(bound, kInf);
  EXPECT_TRUE(is_stale(bound, 1e9));
}

TEST(ProtocolErrorBound, InfiniteWhereNoImpostorHolds) {
  ASSERT_LT(position_bound_px(plain_view(), kPlainCapture, kPlainDrawn), 1e3);
  for (const double d : {0.0, 0.5, 1.0, 1.0 + 1e-7, 1.19}) {  // at the centre, inside, on, above
    ViewGeometry v = plain_view();
    v.eye = {0, 0, d};
    v.center_depth = d;
    expect_stale(v, kPlainCapture, kPlainDrawn);
    expect_stale(plain_view(), {{0, 0, 1}, d, {}, {}, {}, {}}, kPlainDrawn);
  }
  for (const double depth : {1.0, 0.0, -4.0}) {  // beside or behind the eye
    ViewGeometry v = plain_view();
    v.center_depth = depth;
    expect_stale(v, kPlainCapture, kPlainDrawn);
  }
  expect_stale(plain_view(), kPlainCapture,
               {1, 4, 0, 0, 0, 0});  // drawn points reach the eye plane
  expect_stale(plain_view(), kPlainCapture, {-1, 1, 0, 0, 0, 0});  // a negative bound is not valid
}

// The corners of a quad captured from near lie farther out than a near eye, but aside of it. From
// behind it is far off, by a known distance.
TEST(ProtocolErrorBound, FiniteFromBehindHoweverWideTheQuad) {
  ViewGeometry v = plain_view();
  v.eye = {0, 0, -1.32};
  v.center_depth = 1.32;
  v.forward = {0, 0, 1};
  const Capture capture(*view_cell_from_direction({0, 0, 1}, 7),
                        *distance_bucket_from_radii(1.33, 6), 1, 64);
  const CaptureGeometry geometry = capture.geometry();
  // The quad is on the plane through the centre; its corners are 2.2 radii aside.
  const DrawnDepth drawn{2, 2.2, 0, 0, geometry.distance, geometry.distance};
  const double bound = position_bound_px(v, geometry, drawn);
  EXPECT_TRUE(std::isfinite(bound));
  EXPECT_TRUE(is_stale(bound, 100));
}

TEST(ProtocolErrorBound, AnyNonFiniteInputIsStale) {
  for (const double bad : {kNan, kInf, -kInf}) {
    ViewGeometry v = plain_view();
    v.focal_px = bad;
    expect_stale(v, kPlainCapture, kPlainDrawn);
    v = plain_view();
    v.radius = bad;
    expect_stale(v, kPlainCapture, kPlainDrawn);
    v = plain_view();
    v.center_depth = bad;
    expect_stale(v, kPlainCapture, kPlainDrawn);
    for (int i = 0; i < 3; ++i) {
      v = plain_view();
      v.eye[i] = bad;
      expect_stale(v, kPlainCapture, kPlainDrawn);
      CaptureGeometry c = kPlainCapture;
      c.axis[i] = bad;
      expect_stale(plain_view(), c, kPlainDrawn);
    }
    expect_stale(plain_view(), {{0, 0, 1}, bad, {}, {}, {}, {}}, kPlainDrawn);
    expect_stale(plain_view(), kPlainCapture, {bad, 1, 0, 0, 0, 0});
    expect_stale(plain_view(), kPlainCapture, {1, bad, 0, 0, 0, 0});
  }
  EXPECT_TRUE(is_stale(kNan, 1));
  EXPECT_TRUE(is_stale(1, kNan));
  EXPECT_FALSE(is_stale(1, 1));
}

TEST(ProtocolErrorBound, MonotoneInTheAngle) {
  for (const double distance : {3.0, 10.0, 1000.0}) {
    double last = 0;
    for (double theta = 1e-12; theta < 1.5; theta *= 1.5) {
      const double term = baseline_term(distance, distance, theta, 1.0);
      EXPECT_GT(term, last) << theta;
      EXPECT_NEAR(term / (distance * theta), 1, theta + 1e-12);
      last = term;
      // The vector form agrees where it still has digits.
      if (theta < 1e-6) continue;
      ViewGeometry v = plain_view();
      v.eye = glm::dvec3(std::sin(theta), 0, std::cos(theta)) * distance;
      EXPECT_NEAR(baseline_term(v, {{0, 0, 1}, distance, {}, {}, {}, {}}) / term, 1, 1e-8);
    }
  }
}

TEST(ProtocolErrorBound, ZeroAtTheCaptureEye) {
  ViewGeometry v = plain_view();
  v.eye = {0, 0, 3};
  v.center_depth = 3;
  EXPECT_EQ(position_bound_px(v, kPlainCapture, kPlainDrawn), 0);
  EXPECT_FALSE(is_stale(0, 0));
  // The true error is zero on the ray of a point, wherever it is drawn.
  const glm::dvec3 p(0.3, 0.2, -5);
  EXPECT_NEAR(point_error_px(500, p, p * 1.7, {0, 0, -1}, {1, 0, 0}, {0, 1, 0}), 0, 1e-10);
  EXPECT_EQ(point_error_px(500, p, {0, 0, 1}, {0, 0, -1}, {1, 0, 0}, {0, 1, 0}), kInf);
}

TEST(ProtocolErrorBound, TexelSize) {
  // A tile with 100 texels over the cone at distance 3, seen again from 3: the centre's texels.
  ViewGeometry v = plain_view();
  v.eye = {0, 0, 3};
  v.center_depth = 3;
  const double expected = 500 * 2 / std::sqrt(8.0) / 100;
  EXPECT_NEAR(texel_size_px(v, kPlainCapture, 100), expected, 1e-9);
  EXPECT_EQ(texel_size_px(v, kPlainCapture, 0), kInf);
  v.center_depth = 1;
  EXPECT_EQ(texel_size_px(v, kPlainCapture, 100), kInf);
  EXPECT_EQ(footprint_px(0.5), 0);
  EXPECT_EQ(footprint_px(3), 1);
}

TEST(ProtocolCapture, RaysAndWindow) {
  Cases cases;
  for (int i = 0; i < 5000; ++i) {
    const Case c = cases.next();
    const Capture& capture = c.capture;
    const glm::dvec3 p = cases.direction() * (capture.radius * cases.uniform(0, 1));
    const glm::dvec2 t = capture.texel_from_point(p);
    // The guard texel stays free for any object.
    ASSERT_GT(std::min(t.x, t.y), 1 - 1e-9);
    ASSERT_LT(std::max(t.x, t.y), capture.edge - 1 + 1e-9);
    const glm::dvec3 back = capture.point_from_texel(t, capture.depth(p));
    ASSERT_LT(glm::length(back - p), 1e-12 * (capture.distance + capture.radius));
    const glm::dvec3 deeper = capture.point_from_texel(t, capture.depth(p) * 1.5);
    ASSERT_LT(angle_between(deeper - capture.eye(), p - capture.eye()), 1e-12);
  }
}

}  // namespace
}  // namespace mirage::test
