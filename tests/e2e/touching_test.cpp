// Things that touch: a plate on a block, closer to it than a step of stored depth; and a ring
// around a ball, which is in front of it and behind it.

#include <gtest/gtest.h>

#include <cmath>
#include <fstream>

#include "tests/support/gltf_builder.h"
#include "tests/support/viewed.h"

namespace mirage::test {
namespace {

constexpr double kPi = 3.14159265358979;

/// A file of several objects, each in one colour.
class Things {
 public:
  /// Adds a surface of `u` x `v` quads; `at` returns the point at (0..1, 0..1), counter-clockwise
  /// seen from outside.
  template <typename At>
  void add(int u, int v, json color, const At& at) {
    std::vector<float> positions;
    const auto put = [&](double x, double y) {
      const glm::dvec3 p = at(x / u, y / v);
      positions.insert(positions.end(), {float(p.x), float(p.y), float(p.z)});
    };
    for (int y = 0; y < v; ++y) {
      for (int x = 0; x < u; ++x) {
        for (const auto& [dx, dy] : {std::pair{0, 0}, {1, 0}, {1, 1}, {0, 0}, {1, 1}, {0, 1}}) {
          put(x + dx, y + dy);
        }
      }
    }
    const json attributes = {{"POSITION", builder_.vec3(positions)}};
    builder_.mesh(attributes);
    const std::size_t material = builder_.doc["materials"].size();
    builder_.doc["meshes"].back()["primitives"][0]["material"] = material;
    builder_.doc["materials"].push_back(
        {{"pbrMetallicRoughness", {{"baseColorFactor", std::move(color)}, {"metallicFactor", 0}}},
         {"doubleSided", true}});
  }
  /// Writes the file, seen from 3 m along `z` and 1 m aside.
  std::string file() {
    json& doc = builder_.doc;
    doc["cameras"] = {{{"type", "perspective"}, {"perspective", {{"yfov", 0.6}, {"znear", 0.1}}}}};
    const double turn = std::atan2(1.0, 3.0);
    doc["nodes"].push_back({{"camera", 0},
                            {"translation", {1, 0, 3}},
                            {"rotation", {0, std::sin(turn / 2), 0, std::cos(turn / 2)}}});
    doc["scenes"] = {{{"nodes", json::array()}}};
    for (std::size_t i = 0; i < doc["nodes"].size(); ++i) doc["scenes"][0]["nodes"].push_back(i);
    doc["scene"] = 0;
    const std::string path = scratch_folder() + "/things.glb";
    std::ofstream(path, std::ios::binary) << builder_.glb();
    return path;
  }

 private:
  Builder builder_;
};

const json kDark = {0.1, 0.03, 0.02, 1}, kBright = {0.9, 0.8, 0.3, 1};

glm::dvec3 on_ball(double x, double y, double radius) {
  const double a = 2 * kPi * x, b = kPi * (y - 0.5);
  return glm::dvec3(std::cos(a) * std::cos(b), std::sin(b), -std::sin(a) * std::cos(b)) * radius;
}

/// Returns the statistics of a picture at rest of impostors alone.
json at_rest(const std::string& file) {
  const std::string folder = scratch_folder();
  const Server server(file, {"--no-geometry", "--references"});
  EXPECT_TRUE(server.ready()) << server.log();
  return view(server,
              "--offscreen 360x360 --path builtin:still --net rtt=20,rate=100,server-ms=1,seed=1 "
              "--frames 90 --reference 89 --out " +
                  folder,
              folder)
      .stats["quality"];
}

TEST(Touching, APlateOnABlockIsNotStriped) {
  Things things;
  things.add(4, 1, kDark, [](double x, double y) {
    const double a = 2 * kPi * (x - 0.125);
    return glm::dvec3(std::sin(a), std::sqrt(0.5) * (2 * y - 1), std::cos(a)) * std::sqrt(0.5);
  });
  things.add(1, 1, kBright,
             [](double x, double y) { return glm::dvec3(0.3 * x - 0.15, 0.2 * y - 0.1, 0.5015); });
  const json quality = at_rest(things.file());
  std::printf("FLIP %.4f, 99 %% of pixels within %.3f\n", double(quality["flip"]["mean"]),
              double(quality["flip"]["pixels_p99"]));
  // With stripes .08 and .98.
  EXPECT_LT(quality["flip"]["mean"], 0.03);
  EXPECT_LT(quality["flip"]["pixels_p99"], 0.4);
  EXPECT_EQ(quality["bound_violations"], 0);
  EXPECT_GT(quality["compared_pixels"], 10'000);
}

TEST(Touching, TheEdgesOfARingAroundABallShowTheBall) {
  Things things;
  things.add(48, 24, kBright, [](double x, double y) { return on_ball(x, y, 0.45); });
  things.add(48, 1, kDark, [](double x, double y) {
    const glm::dvec3 p = on_ball(x, 0.5, 0.5);
    return glm::dvec3(p.x, 0.2 * (y - 0.5) + 0.5 * p.x, p.z);
  });
  const json quality = at_rest(things.file());
  std::printf("FLIP %.4f, 99 %% of pixels within %.3f\n", double(quality["flip"]["mean"]),
              double(quality["flip"]["pixels_p99"]));
  // Where the edges show the sky instead, .058 and .46.
  EXPECT_LT(quality["flip"]["mean"], 0.048);
  EXPECT_LT(quality["flip"]["pixels_p99"], 0.33);
  EXPECT_EQ(quality["bound_violations"], 0);
}

}  // namespace
}  // namespace mirage::test
