// The table of stable forms (numerics.md section 3), row by row where protocol/ computes it. Each
// form is compared with long double over its range, beside the textbook form, which fails there.
// Angles, 1 - cos, tangent lengths, gains and unit vectors: protocol_view_cell_test.cpp.
#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "protocol/base/limits.h"
#include "protocol/base/stable_math.h"
#include "protocol/codec/vertex_codec.h"
#include "protocol/impostor/camera.h"
#include "protocol/impostor/error_bound.h"
#include "protocol/impostor/sun_frame.h"
#include "protocol/model/animation.h"

namespace mirage::test {
namespace {

using Exact = long double;

class Random {
 public:
  double uniform(double low, double high) {
    return low + (high - low) * std::uniform_real_distribution<double>(0, 1)(engine_);
  }
  glm::dvec3 direction() {
    std::normal_distribution<double> n;
    return safe_normalize({n(engine_), n(engine_), n(engine_)});
  }

 private:
  std::mt19937_64 engine_{17};
};

// Angles off the axis and of the sphere's rim, in the bound for moved objects.
TEST(ProtocolStable, MotionBoundNearAxisAndRim) {
  const auto exact = [](Exact focal, Exact travel, Exact distance, Exact depth, Exact radius) {
    const Exact aside = std::sqrt((distance - depth) * (distance + depth));
    const Exact rim = std::sqrt((distance - radius) * (distance + radius));
    // Computes cos(a + b) from both triangles, without any angle.
    const Exact cosine = (depth * rim - aside * radius) / (distance * distance);
    return focal * travel / ((depth - radius) * cosine);
  };
  for (double lean = 1e-9; lean < 0.6; lean *= 3) {
    for (const double radii : {1.3, 5.0, 1e3, 1e6}) {
      ViewGeometry view;
      view.focal_px = 500;
      view.radius = 1;
      view.eye = {0, 0, radii};
      view.center_depth = radii * (1 - one_minus_cos(lean));
      const double bound = motion_bound_px(view, 0.01);
      const Exact expected = exact(500, 0.01L, radii, view.center_depth, 1);
      if (!(expected > 0) || expected > 1e4) continue;
      EXPECT_NEAR(static_cast<double>(bound / expected), 1, 1e-12) << lean << " " << radii;
    }
  }
  // acos() of the ratio loses an angle of a billionth.
  EXPECT_EQ(std::acos(1 - one_minus_cos(1e-9)), 0);
}

// Rotation keys that nearly agree, and keys of opposite signs.
TEST(ProtocolStable, Slerp) {
  for (double angle = 1e-12; angle < 3; angle *= 7) {
    const glm::dquat a(1, 0, 0, 0);
    const glm::dquat b(std::cos(angle / 2), std::sin(angle / 2), 0, 0);
    for (const double share : {0.0, 0.25, 0.5, 1.0}) {
      const Exact half = static_cast<Exact>(angle) * share / 2;
      for (const glm::dquat& end : {b, -b}) {
        const glm::dquat q = slerp_shortest(a, end, share);
        EXPECT_NEAR(static_cast<double>(q.x - std::sin(half)), 0, 1e-15 + angle * 1e-12) << angle;
        EXPECT_NEAR(glm::length(q), 1, 1e-15);
      }
    }
  }
  const double cosine = std::cos(1e-9);
  EXPECT_TRUE(std::isnan(std::sin(0.5 * std::acos(cosine)) / std::sin(std::acos(cosine))));
}

// 10 bits a component: the best of four codes, within the error that numerics.md states.
TEST(ProtocolStable, OctahedralCodes) {
  Random random;
  VertexLayout layout;
  layout.position = {glm::vec3(0), glm::vec3(1)};
  double worst = 0;
  for (int i = 0; i < 200'000; ++i) {
    glm::dvec3 n = random.direction();
    if (i % 4 == 0) n[i / 4 % 3] *= 1e-6;  // the map's folds
    Vertex v;
    v.normal = glm::vec3(glm::normalize(n));
    ByteWriter writer;
    put_vertex(writer, v, layout);
    ByteReader reader(writer.bytes.data(), writer.bytes.size());
    worst = std::max(
        worst, angle_between(glm::dvec3(get_vertex(reader, layout).normal), glm::dvec3(v.normal)));
  }
  const double degrees = worst * 57.29577951308232;
  EXPECT_LT(degrees, 0.17);
  EXPECT_GT(degrees, 0.10);  // rounding to the nearest code reaches 0.24
}

// World minus eye, in double.
TEST(ProtocolStable, WorldFarFromTheOrigin) {
  for (const double far : {1e6, 1e9}) {
    const glm::dvec3 eye(far, far, -far), point = eye + glm::dvec3(0.1328125, 0.2578125, -2);
    Camera camera;
    camera.pose.eye = eye;
    const glm::dvec3 expected = camera.pixel_from_relative({0.1328125, 0.2578125, -2});
    const glm::dvec3 here = camera.pixel_from_relative(glm::dvec3(glm::vec3(point - eye)));
    EXPECT_LT(glm::length(glm::dvec2(here) - glm::dvec2(expected)), 1e-5);
    const glm::dvec3 naive =
        camera.pixel_from_relative(glm::dvec3(glm::vec3(point) - glm::vec3(eye)));
    EXPECT_FALSE(glm::length(glm::dvec2(naive) - glm::dvec2(expected)) < 1);
  }
}

// Graphics cards drop triangles whose w is far below 1.
TEST(ProtocolStable, ClipSpaceIsNearOneForScenesOfAnySize) {
  for (const double size : {1e-30, 1e-20, 1e-3, 1.0, 40.0, 1e9, 1e20, 1e30}) {
    Camera camera;
    camera.fit_depth_range({0, 0, -3 * size}, size);
    for (const DepthMapping mapping : {DepthMapping::kForward, DepthMapping::kReversed}) {
      for (const double z : {2 * size, 3 * size, 4 * size}) {
        const glm::vec4 clip = camera.clip_from_relative(mapping) * glm::vec4(0.2 * size, 0, -z, 1);
        EXPECT_GT(clip.w, 0.4) << size;
        EXPECT_LT(clip.w, 2) << size;
        EXPECT_NEAR(clip.w * camera.depth_of_w() / z, 1, 1e-6) << size;
        const glm::dvec3 pixel = camera.pixel_from_relative({0.2 * size, 0, -z});
        EXPECT_NEAR(0.5 * camera.width * (1 + clip.x / clip.w), pixel.x, 1e-3) << size;
        const float depth = clip.z / clip.w;
        EXPECT_TRUE(depth > -1 && depth < 1) << size;
      }
    }
  }
  EXPECT_EQ(clip_scale(1), 1);
  EXPECT_EQ(clip_scale(7), 0.25);
}

// Window depth of two surfaces a millionth apart, in float like a depth buffer.
TEST(ProtocolStable, ReversedDepthKeepsOrder) {
  Camera camera;
  camera.fit_depth_range({0, 0, 0}, 1e9);
  const auto depth = [&](DepthMapping mapping, double z) {
    const glm::vec4 clip = camera.clip_from_relative(mapping) * glm::vec4(0, 0, -z, 1);
    const float ndc = clip.z / clip.w;
    return mapping == DepthMapping::kReversed ? ndc : 0.5f * ndc + 0.5f;
  };
  for (double z = 1e-3; z < 1e9; z *= 3.3) {
    const float near = depth(DepthMapping::kReversed, z);
    EXPECT_GT(near, depth(DepthMapping::kReversed, z * (1 + 1e-6))) << z;
    const glm::dvec2 window = camera.window_depth(DepthMapping::kReversed);
    EXPECT_NEAR(window.y / (double{near} - window.x) / z, 1, 1e-6);
    const double forward = depth(DepthMapping::kForward, z);
    const glm::dvec2 other = camera.window_depth(DepthMapping::kForward);
    if (z > camera.near_for(DepthMapping::kForward)) {
      EXPECT_NEAR(forward, other.x + other.y / z, 1e-6);
    }
  }
  EXPECT_EQ(depth(DepthMapping::kForward, 0.9e9),
            depth(DepthMapping::kForward, 0.9e9 * (1 + 1e-6)));
}

// The sun's frame towards -z, where Frisvad's basis divides by zero.
TEST(ProtocolStable, BasisWithoutAPole) {
  for (const double lean : {0.0, 1e-300, 1e-12, 1e-7, 1e-4}) {
    const SunFrame frame(glm::vec3(glm::dvec3(lean, -lean, 1)), {0, 0, 0}, 1, 64);
    EXPECT_NEAR(glm::length(frame.right), 1, 1e-12);
    EXPECT_NEAR(glm::length(frame.up), 1, 1e-12);
    EXPECT_NEAR(glm::dot(frame.right, frame.up), 0, 1e-12);
    EXPECT_NEAR(glm::dot(frame.right, frame.forward), 0, 1e-12);
  }
  const float nz = -1;
  EXPECT_FALSE(std::isfinite(1 / (1 + nz)));
}

}  // namespace
}  // namespace mirage::test
