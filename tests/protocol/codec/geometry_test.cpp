// Proxies and the viewer's camera.
#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "protocol/base/stable_math.h"
#include "protocol/impostor/camera.h"
#include "protocol/impostor/object_proxy.h"

namespace mirage::test {
namespace {

class RandomPoints {
 public:
  double uniform(double low, double high) {
    return low + (high - low) * std::uniform_real_distribution<double>(0, 1)(engine_);
  }
  glm::dvec3 in_box(double half) {
    return {uniform(-half, half), uniform(-half, half), uniform(-half, half)};
  }
  glm::dvec3 direction() {
    while (true) {
      const glm::dvec3 v = in_box(1);
      if (glm::length(v) > 1e-3 && glm::length(v) < 1) return glm::normalize(v);
    }
  }

 private:
  std::mt19937_64 engine_{21};
};

ConvexHull tetrahedron() {
  return {{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}}, {0, 2, 1, 0, 1, 3, 0, 3, 2, 1, 2, 3}, {}};
}

TEST(ProtocolProxy, RayEntersABox) {
  const auto box = box_planes({-1, -2, -3}, {1, 2, 3});
  ASSERT_EQ(box.size(), 6u);
  EXPECT_DOUBLE_EQ(ray_entry(box, {0, 0, 10}, {0, 0, -1}), 7);
  EXPECT_DOUBLE_EQ(ray_entry(box, {0, 0, 10}, {0, 0, -2}), 3.5);
  EXPECT_DOUBLE_EQ(ray_entry(box, {-5, 1, 1}, {1, 0, 0}), 4);
  EXPECT_LT(ray_entry(box, {0, 0, 10}, {0, 0, 1}), 0);   // behind
  EXPECT_LT(ray_entry(box, {0, 3, 10}, {0, 0, -1}), 0);  // beside, parallel to two planes
  EXPECT_LT(ray_entry(box, {-5, 0, 0}, {1, 0.7, 0}), 0);
  EXPECT_EQ(ray_entry(box, {0, 0, 0}, {0, 0, 1}), 0);  // from inside
}

TEST(ProtocolProxy, EntryIsOnTheSurface) {
  RandomPoints random;
  for (const auto& planes :
       {box_planes({-1, -0.5, -0.25}, {1, 0.5, 0.25}), tetrahedron().planes()}) {
    const auto depth_inside = [&](const glm::dvec3& p) {  // negative outside
      double least = 1e300;
      for (const Plane& plane : planes) {
        least = std::min(least, plane.offset - glm::dot(plane.normal, p));
      }
      return least;
    };
    int hits = 0;
    for (int i = 0; i < 20'000; ++i) {
      const glm::dvec3 origin = random.direction() * 4.0;
      const glm::dvec3 direction = glm::normalize(random.in_box(1.2) - origin);
      const double t = ray_entry(planes, origin, direction);
      if (t >= 0) {
        ++hits;
        ASSERT_NEAR(depth_inside(origin + direction * t), 0, 1e-9);
        ASSERT_LT(depth_inside(origin + direction * (t - 1e-3)), 0);
      } else {
        for (double s = 0; s < 8; s += 0.1) {
          ASSERT_LT(depth_inside(origin + direction * s), 1e-12);
        }
      }
    }
    EXPECT_GT(hits, 500);
  }
}

TEST(ProtocolProxy, HullPlanesPointOutwards) {
  const auto planes = tetrahedron().planes();
  ASSERT_EQ(planes.size(), 4u);
  for (const Plane& plane : planes) {
    EXPECT_NEAR(glm::length(plane.normal), 1, 1e-6);
    EXPECT_LT(glm::dot(plane.normal, glm::dvec3(0.2)), plane.offset);
  }
  ConvexHull flat = tetrahedron();
  flat.vertices[1] = flat.vertices[0];  // two of the triangles lose their area
  EXPECT_EQ(flat.planes().size(), 2u);
  EXPECT_TRUE(ConvexHull{}.planes().empty());
}

TEST(ProtocolProxy, HullPlanesCutOffNoVertex) {
  ConvexHull hull = tetrahedron();
  // A triangle at the corner of the tetrahedron, so narrow that rounding leans its plane inwards.
  hull.vertices.insert(hull.vertices.end(), {{1e-6f, 0, 0}, {0, 1e-6f, 1e-6f}});
  hull.indices.insert(hull.indices.end(), {0, 4, 5});
  const auto planes = hull.planes();
  ASSERT_EQ(planes.size(), 5u);
  for (const Plane& plane : planes) {
    for (const glm::vec3& v : hull.vertices) {
      EXPECT_LE(glm::dot(plane.normal, glm::dvec3(v)), plane.offset);
    }
  }
}

TEST(ProtocolProxy, Extents) {
  ObjectDescription object;
  object.center = {0.5f, 0, 0};
  object.box_min = {-1, -2, -2};
  object.box_max = {1, 1, 1};
  object.hull = tetrahedron();
  EXPECT_NEAR(box_extent(object), std::sqrt(1.5 * 1.5 + 4 + 4), 1e-12);
  EXPECT_NEAR(hull_extent(object), std::sqrt(1.25), 1e-12);
}

Camera some_camera(RandomPoints& random) {
  Camera camera;
  camera.pose = look_at(random.in_box(100), random.in_box(100));
  camera.fov_y = random.uniform(0.1, 2.5);
  camera.width = static_cast<std::uint32_t>(random.uniform(64, 2000));
  camera.height = static_cast<std::uint32_t>(random.uniform(64, 2000));
  return camera;
}

Camera some_lopsided_camera(RandomPoints& random) {
  Camera camera = some_camera(random);
  camera.shift_px = {camera.width * random.uniform(-0.8, 0.8),
                     camera.height * random.uniform(-0.8, 0.8)};
  camera.pixel_aspect = random.uniform(0.5, 2);
  return camera;
}

TEST(ProtocolCamera, PixelsAgreeWithTheMatrix) {
  RandomPoints random;
  for (int i = 0; i < 5000; ++i) {
    const Camera camera = some_lopsided_camera(random);
    const glm::dvec3 p = camera.forward() * random.uniform(1, 100) + random.in_box(0.9);
    const glm::dvec3 pixel = camera.pixel_from_relative(p);
    if (!(pixel.z > 0.2)) continue;
    const glm::dvec4 clip = glm::dmat4(camera.clip_from_relative()) * glm::dvec4(p, 1);
    const double x = (clip.x / clip.w * 0.5 + 0.5) * camera.width;
    const double y = (0.5 - clip.y / clip.w * 0.5) * camera.height;
    const double tolerance = 1e-5 * (std::abs(x) + std::abs(y) + camera.width + camera.height);
    ASSERT_NEAR(pixel.x, x, tolerance);
    ASSERT_NEAR(pixel.y, y, tolerance);
    ASSERT_NEAR(pixel.z, clip.w * camera.depth_of_w(), 1e-4 * pixel.z);
  }
}

TEST(ProtocolCamera, AShiftMovesThePictureByPixels) {
  RandomPoints random;
  for (int i = 0; i < 1000; ++i) {
    Camera camera = some_camera(random);
    const glm::dvec3 p = camera.forward() * random.uniform(1, 100) + random.in_box(0.3);
    const auto drawn = [&] {
      const glm::dvec4 clip = glm::dmat4(camera.clip_from_relative()) * glm::dvec4(p, 1);
      return glm::dvec2(clip.x / clip.w * 0.5 * camera.width,
                        clip.y / clip.w * 0.5 * camera.height);
    };
    const glm::dvec2 before = drawn();
    camera.shift_px = {random.uniform(-1, 1), random.uniform(-1, 1)};
    const double tolerance = 1e-5 * (glm::length(before) + camera.width + camera.height);
    ASSERT_NEAR(glm::distance(drawn() - before, camera.shift_px), 0, tolerance);
  }
}

// The edges of the picture lie where the tangents say, and an enclosing camera sees all of it.
TEST(ProtocolCamera, FourTangentsAreTheEdgesOfThePicture) {
  RandomPoints random;
  for (int i = 0; i < 1000; ++i) {
    Camera camera = some_camera(random);
    ViewTangents t{random.uniform(-2, 1), 0, random.uniform(-2, 1), 0};
    t.right = t.left + random.uniform(0.1, 3);
    t.up = t.down + random.uniform(0.1, 3);
    ASSERT_TRUE(set_tangents(camera, t));
    const Camera whole = camera.enclosing();
    EXPECT_EQ(whole.shift_px, glm::dvec2(0));
    const auto see = [&](double x, double y) {
      return camera.forward() + x * camera.right() + y * camera.up();
    };
    for (const double x : {t.left, t.right}) {
      for (const double y : {t.down, t.up}) {
        const glm::dvec3 pixel = camera.pixel_from_relative(see(x, y));
        ASSERT_NEAR(pixel.x, x == t.left ? 0 : camera.width, 1e-2);
        ASSERT_NEAR(pixel.y, y == t.down ? camera.height : 0, 1e-2);
        const glm::dvec3 in_whole = whole.pixel_from_relative(see(x, y));
        ASSERT_TRUE(in_whole.x > -1 && in_whole.x < whole.width + 1);
        ASSERT_TRUE(in_whole.y > -1 && in_whole.y < whole.height + 1);
      }
    }
    ASSERT_GE(whole.focal_px(), camera.focal_px() * 0.999);
    const Camera twice = camera.at_size(2 * camera.width, 2 * camera.height);
    ASSERT_NEAR(twice.pixel_from_relative(see(t.right, t.up)).x, 2.0 * camera.width, 2e-2);
  }
  Camera camera;
  for (const ViewTangents& bad :
       {ViewTangents{1, -1, -1, 1}, ViewTangents{-1, 1, 0, 0}, ViewTangents{std::nan(""), 1, -1, 1},
        ViewTangents{-HUGE_VAL, 1, -1, 1}}) {
    EXPECT_FALSE(set_tangents(camera, bad));
    EXPECT_EQ(camera.fov_y, Camera().fov_y);
  }
  EXPECT_TRUE(set_tangents(camera, {-1, 1, -0.5625, 0.5625}));
  EXPECT_EQ(camera.enclosing().width, camera.width) << "this one itself";
}

TEST(ProtocolCamera, LooksAtItsTarget) {
  RandomPoints random;
  for (int i = 0; i < 2000; ++i) {
    const glm::dvec3 eye = random.in_box(10), target = eye + random.direction() * 3.0;
    Camera camera;
    camera.pose = look_at(eye, target);
    const glm::dvec3 pixel = camera.pixel_from_relative(target - eye);
    ASSERT_NEAR(pixel.x, 320, 1e-2);
    ASSERT_NEAR(pixel.y, 180, 1e-2);
    ASSERT_GT(camera.up().y, -1e-6);
  }
  for (const double y : {1.0, -1.0}) {  // straight up and down, and no direction at all
    Camera camera;
    camera.pose = look_at({0, 0, 0}, {0, y, 0});
    EXPECT_NEAR(camera.forward().y, y, 1e-6);
  }
  Camera camera;
  camera.pose = look_at({1, 2, 3}, {1, 2, 3});
  EXPECT_NEAR(camera.forward().z, -1, 1e-6);
}

TEST(ProtocolCamera, DepthRangeHoldsTheScene) {
  Camera camera;
  camera.pose.eye = {0, 0, 50};
  camera.fit_depth_range({0, 0, 0}, 10);
  EXPECT_GT(camera.far_m, 60);
  EXPECT_LT(camera.far_m, 62);
  EXPECT_GT(camera.near_m, 0);
  EXPECT_LT(camera.near_m, 0.1);
}

// A sphere is left out only if no point of it is in the picture.
TEST(ProtocolCamera, MaySeeIsConservative) {
  RandomPoints random;
  int hidden = 0, missed_by_points = 0;
  for (int i = 0; i < 20'000; ++i) {
    const Camera camera = i % 2 == 0 ? some_camera(random) : some_lopsided_camera(random);
    const double radius = random.uniform(0.01, 3);
    const glm::dvec3 center = random.direction() * random.uniform(0.1, 12);
    bool visible = false;
    for (int k = 0; k < 40 && !visible; ++k) {
      const glm::dvec3 p = center + random.direction() * (radius * random.uniform(0.5, 1));
      const glm::dvec3 pixel = camera.pixel_from_relative(p);
      visible = pixel.z > 0 && pixel.x >= 0 && pixel.y >= 0 && pixel.x <= camera.width &&
                pixel.y <= camera.height;
    }
    const bool may = Frustum(camera).may_see(center, radius);
    if (visible) {
      ASSERT_TRUE(may) << "case " << i;
      ASSERT_TRUE(Frustum(camera, 0.1).may_see(center, radius)) << "case " << i;
    } else {
      ++missed_by_points;
    }
    hidden += may ? 0 : 1;
  }
  // Most hidden spheres are left out.
  EXPECT_GT(hidden, missed_by_points * 8 / 10);
}

TEST(ProtocolCamera, GuardWidensTheView) {
  Camera camera;  // looks along -z, 60 degrees high
  const glm::dvec3 above = glm::dvec3(0, std::sin(0.6), -std::cos(0.6)) * 10.0;
  EXPECT_FALSE(Frustum(camera).may_see(above, 0.01));
  EXPECT_FALSE(Frustum(camera, 0.05).may_see(above, 0.01));
  EXPECT_TRUE(Frustum(camera, 0.1).may_see(above, 0.01));
  EXPECT_FALSE(Frustum(camera).may_see({0, 0, 10}, 1));  // behind
  EXPECT_TRUE(Frustum(camera).may_see({0, 0, 1}, 2));    // around the eye
}

}  // namespace
}  // namespace mirage::test
