// Home view: it fills pictures of every shape.
#include <gtest/gtest.h>

#include <cmath>

#include "protocol/impostor/camera.h"
#include "protocol/model/scene_types.h"

namespace mirage {
namespace {

HomeView long_thing() {
  HomeView home;
  home.target = {10, 20, 30};
  home.eye = home.target + glm::dvec3(6, 3.5, 10);
  for (const float x : {-4.0f, 4.0f}) {
    for (const float y : {-1.0f, 1.0f}) {
      for (const float z : {-0.5f, 0.5f}) home.fit.emplace_back(x, y, z);
    }
  }
  return home;
}

struct Seen {
  glm::dvec2 low{9}, high{-9};  // -1 to 1: the picture
};

Seen seen(const HomeView& home, Camera camera) {
  camera.pose = home_pose(home, camera);
  Seen out;
  for (const glm::vec3& point : home.fit) {
    const glm::dvec3 relative = home.target + glm::dvec3(point) - camera.pose.eye;
    const glm::dvec3 at = camera.pixel_from_relative(relative);
    EXPECT_GT(at.z, 0) << "behind the eye";
    const glm::dvec2 place(2 * at.x / camera.width - 1, 2 * at.y / camera.height - 1);
    out.low = glm::min(out.low, place);
    out.high = glm::max(out.high, place);
  }
  return out;
}

TEST(ImpostorHomePose, PointsFillFourFifthsOfEveryPictureAroundItsMiddle) {
  int full = 0;
  for (const auto& [width, height] : {std::pair{1280u, 720u}, {390u, 844u}, {500u, 500u}}) {
    for (const double degrees : {20.0, 60.0, 110.0}) {
      Camera camera;
      camera.width = width;
      camera.height = height;
      camera.fov_y = degrees * 0.017453292519943295;
      const Seen at = seen(long_thing(), camera);
      const glm::dvec2 filled = 0.5 * (at.high - at.low), off = glm::abs(at.low + at.high);
      const int across = filled.x > filled.y ? 0 : 1;  // the way in which the picture is full
      const glm::dvec3 way = home_pose(long_thing(), camera).eye - long_thing().target;
      const glm::dvec3 back = glm::normalize(long_thing().eye - long_thing().target);
      const double halves = glm::dot(way, back) / glm::length(long_thing().fit.front());
      EXPECT_GT(halves, 1.19) << "half diagonals; its box in the view is larger";
      if (filled[across] < 0.799) {
        EXPECT_LT(halves, 1.7) << "the eye goes no nearer";
        continue;
      }
      ++full;
      EXPECT_NEAR(filled[across], 0.8, 1e-3) << width << " at " << degrees;
      EXPECT_NEAR(off[across], 0, 1e-3);
      EXPECT_LT(off[1 - across], 0.6) << "about in the middle";
    }
  }
  EXPECT_GE(full, 4);
}

TEST(ImpostorHomePose, WithoutPointsTheEyeStays) {
  HomeView home = long_thing();
  home.fit.clear();
  EXPECT_EQ(home_pose(home, Camera()).eye, home.eye);
  home.fit = {glm::vec3(0)};
  EXPECT_EQ(home_pose(home, Camera()).eye, home.eye) << "a point needs no distance";
  home.fit = {glm::vec3(std::nanf(""))};
  EXPECT_EQ(home_pose(home, Camera()).eye, home.eye);
}

}  // namespace
}  // namespace mirage
