// Camera paths: smooth, finite, and traces that say which line is wrong.
#include "client/frame/camera_path.h"

#include <gtest/gtest.h>
#include <unistd.h>

#include <cmath>
#include <cstdio>
#include <filesystem>
#include <fstream>

#include "protocol/base/stable_math.h"

namespace mirage::test {
namespace {

Result<CameraPath> path_of(const std::string& spec) {
  return CameraPath::create(spec, HomeView{}, {0, 0, 0}, 40);
}

double angle(const glm::quat& a, const glm::quat& b) {
  const glm::dquat d = glm::dquat(a) * glm::conjugate(glm::dquat(b));
  return 2 * std::atan2(glm::length(glm::dvec3(d.x, d.y, d.z)), std::abs(d.w));
}

/// A trace file that is deleted with the test.
class TraceFile {
 public:
  explicit TraceFile(const std::string& text) { std::ofstream(path_) << text; }
  TraceFile(const TraceFile&) = delete;
  TraceFile& operator=(const TraceFile&) = delete;
  ~TraceFile() { std::filesystem::remove(path_); }
  const std::string& path() const { return path_; }

 private:
  const std::string path_ = (std::filesystem::temp_directory_path() /
                             ("mirage_trace_" + std::to_string(::getpid()) + "_" +
                              ::testing::UnitTest::GetInstance()->current_test_info()->name()))
                                .string();
};

TEST(CoreCameraPath, BuiltinsAreFiniteAndContinuous) {
  for (const char* name : {"still", "orbit", "walk", "fly", "shake", "strafe", "teleport"}) {
    const auto path = path_of(std::string("builtin:") + name);
    ASSERT_TRUE(path) << name;
    const bool jumps = std::string(name) == "teleport";
    Pose before = path->at(0);
    for (int i = 1; i <= 60'000; ++i) {
      const Pose pose = path->at(i * 1e-3);
      ASSERT_TRUE(is_finite(pose.eye)) << name << " at " << i << " ms";
      ASSERT_NEAR(glm::length(glm::dquat(pose.rotation)), 1, 1e-5) << name << " at " << i << " ms";
      // 20 m/s and 250 degrees a second; a float quaternion rounds to about 1e-6 rad.
      if (!jumps || i % 1000 != 0) {
        ASSERT_LE(glm::length(pose.eye - before.eye), 0.020) << name << " at " << i << " ms";
        ASSERT_LE(angle(pose.rotation, before.rotation), 0.00437) << name << " at " << i << " ms";
      }
      before = pose;
    }
  }
}

TEST(CoreCameraPath, AViewOfABrowsersAddressStandsStill) {
  const auto path = path_of("http://host:9870/#eye=1,2,3&look=1,2,-7&light=10,20");
  ASSERT_TRUE(path);
  EXPECT_EQ(path->at(0).eye, glm::dvec3(1, 2, 3));
  EXPECT_EQ(path->at(9).eye, glm::dvec3(1, 2, 3));
  const glm::vec3 ahead = path->at(5).rotation * glm::vec3(0, 0, -1);
  EXPECT_NEAR(glm::length(ahead - glm::vec3(0, 0, -1)), 0, 1e-6);
  for (const char* wrong : {"#eye=1,2,3", "#eye=1,2,3&look=1,2,3", "#eye=1,2&look=0,0,0",
                            "#eye=1,2,nan&look=0,0,0", "#eye=a,b,c&look=1,1,1"}) {
    EXPECT_FALSE(path_of(wrong)) << wrong;
  }
}
TEST(CoreCameraPath, TeleportJumpsEverySecond) {
  const auto path = path_of("builtin:teleport");
  ASSERT_TRUE(path);
  for (int s = 1; s < 5; ++s) {
    EXPECT_GT(glm::length(path->at(s).eye - path->at(s - 0.001).eye), 5);
  }
}

TEST(CoreCameraPath, WalkKeepsItsSpeedAndItsCircle) {
  const auto path = path_of("builtin:walk");
  ASSERT_TRUE(path);
  double length = 0;
  for (int i = 1; i <= 6000; ++i) {
    const glm::dvec3 step = path->at(i * 0.01).eye - path->at((i - 1) * 0.01).eye;
    length += std::hypot(step.x, step.z);
    const glm::dvec3 from_center = path->at(i * 0.01).eye - glm::dvec3(20, 1.7, 0);
    ASSERT_NEAR(std::hypot(from_center.x, from_center.z), 20, 1e-9);
  }
  EXPECT_NEAR(length / 60, 1.4, 0.14);
}

TEST(CoreCameraPath, UnknownNamesAndMissingFiles) {
  const auto unknown = path_of("builtin:sprint");
  ASSERT_FALSE(unknown);
  EXPECT_EQ(unknown.error().id, ErrorId::kUsage);
  const auto missing = path_of("/nowhere/at/all.path");
  ASSERT_FALSE(missing);
  EXPECT_EQ(missing.error().id, ErrorId::kIo);
}

TEST(CoreCameraPath, BadLinesAreNamed) {
  const struct {
    const char* text;
    int line;
  } cases[] = {
      {"0 0 0 0 0 0 0\n0 0 0 0 0 0\n", 2},     // a missing column
      {"# comment\n\n0 0 0 0 0 0 abc\n", 3},   // not a number
      {"0 0 0 0 0 0 10\n0 0 0 0 0 0 9\n", 2},  // the time falls
      {"0 0 0 0 0 0 0\n0 0 0 0 0 0 5\n0 0 nan 0 0 0 6\n", 3},
      {"0 0 0 0 0 0 0\n1e999 0 0 0 0 0 6\n", 2},
  };
  for (const auto& c : cases) {
    const TraceFile file(c.text);
    const auto path = path_of(file.path());
    ASSERT_FALSE(path) << c.text;
    EXPECT_EQ(path.error().id, ErrorId::kUsage);
    const std::string where = file.path() + ":" + std::to_string(c.line) + ":";
    EXPECT_NE(path.error().text.find(where), std::string::npos) << path.error().text;
  }
  const TraceFile empty("# nothing\n");
  EXPECT_FALSE(path_of(empty.path()));
}

TEST(CoreCameraPath, EqualTimesAreNotFalling) {
  // Each of these in whole and in fractional milliseconds, twice.
  std::string text;
  for (int i = 0; i < 2000; ++i) {
    char line[64];
    std::snprintf(line, sizeof(line), "0 0 0 0 0 0 %.3f\n", i * 8.333);
    text += line;
    text += line;
  }
  const TraceFile file(text);
  const auto path = path_of(file.path());
  EXPECT_TRUE(path) << path.error().text;
}

TEST(CoreCameraPath, TraceInterpolatesAndClamps) {
  const TraceFile file("0 0 0  0 0 0  1000\r\n# yaw by 90 degrees\r\n2 4 6  0 90 0  2000\r\n");
  const auto path = path_of(file.path());
  ASSERT_TRUE(path) << path.error().text;
  EXPECT_EQ(path->at(0).eye, glm::dvec3(0));
  EXPECT_EQ(path->at(-1e9).eye, glm::dvec3(0));
  EXPECT_EQ(path->at(1e9).eye, glm::dvec3(2, 4, 6));
  const Pose half = path->at(1.5);
  EXPECT_NEAR(glm::length(half.eye - glm::dvec3(1, 2, 3)), 0, 1e-12);
  const auto yaw = [](double degrees) {
    return glm::angleAxis(static_cast<float>(glm::radians(degrees)), glm::vec3(0, 1, 0));
  };
  EXPECT_LT(angle(half.rotation, yaw(45)), 1e-5);
  EXPECT_LT(angle(path->at(1.25).rotation, yaw(22.5)), 1e-5);
  EXPECT_LT(angle(path->at(2).rotation, yaw(90)), 1e-5);
}

TEST(CoreCameraPath, TraceTurnsTheShorterWay) {
  const TraceFile file("0 0 0 0 170 0 0\n0 0 0 0 -170 0 1000\n");
  const auto path = path_of(file.path());
  ASSERT_TRUE(path);
  const glm::quat half_turn = glm::angleAxis(3.14159265f, glm::vec3(0, 1, 0));
  EXPECT_LT(angle(path->at(0.5).rotation, half_turn), 1e-4);
}

}  // namespace
}  // namespace mirage::test
