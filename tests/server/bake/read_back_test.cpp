// Each target's files, read as its consumer reads them, show the object that was baked: every
// covered texel gives back a point of its surface, its normal and its colour.

#include <gtest/gtest.h>

#include <cmath>

#include "tests/server/bake/arrows.h"
#include "tests/server/bake/baked.h"

namespace mirage {
namespace {

using consumer::Consumer;
using consumer::Lattice;
using glm::dvec3;

struct Case {
  const char* target;
  BakeLayout layout;
  int grid, tile;
};

Lattice lattice_of(BakeLayout layout) {
  return layout == BakeLayout::kHemi         ? Lattice::kHemi
         : layout == BakeLayout::kOctahedral ? Lattice::kWhole
                                             : Lattice::kRing;
}

std::map<std::string, glm::dvec4> raw_at(const consumer::Pictures& pictures, glm::ivec2 pixel) {
  std::map<std::string, glm::dvec4> out;
  for (const auto& [map, picture] : pictures) out[map] = picture.at(pixel.x, pixel.y);
  return out;
}

// Colours of 5 bits have the largest steps.
constexpr double kColorStep = .5 / 31 + .001;
constexpr double kDepthSteps = 1.5 * 2 * kArrowsRadius / 255;
constexpr double kDegree = M_PI / 180;

class ReadBack : public testing::TestWithParam<Case> {
 protected:
  void check_frame(const Consumer& reader, const Baked& bake, int i, int j) {
    const Case& c = GetParam();
    const dvec3 toward = reader.direction(lattice_of(c.layout), c.grid, i, j);
    const consumer::Axes axes = reader.axes(toward);
    const glm::dmat3 gltf = reader.gltf_from_own;
    for (int t = 0; t < c.tile * c.tile; ++t) {
      const int x = t % c.tile, y = t / c.tile;
      const consumer::Sample sample = reader.decode(
          raw_at(bake.pictures, reader.pixel(c.grid, c.tile, i, j, x, y)), axes, toward);
      const dvec3 plane =
          axes.right * ((x + .5) / c.tile * 2 - 1) + axes.up * (1 - (y + .5) / c.tile * 2);
      const dvec3 far = kArrowsCenter + gltf * (plane + toward * 2.0) * kArrowsRadius;
      const auto hit = hit_arrows(far, gltf * toward);
      ASSERT_EQ(sample.covered, hit.has_value())
          << "frame " << i << " " << j << " texel " << x << " " << y;
      if (!hit) continue;
      ++covered_;
      const dvec3 point = kArrowsCenter + gltf * (plane + toward * sample.height) * kArrowsRadius;
      check_texel(reader, sample, point, *hit, dot(hit->normal, gltf * toward));
    }
  }

  // `facing`: cosine between the normal and the direction to the camera.
  void check_texel(const Consumer& reader, const consumer::Sample& sample, const dvec3& point,
                   const SurfaceHit& hit, double facing) {
    const dvec3 off = glm::abs(sample.color - hit.color);
    ASSERT_LT(std::max({off.r, off.g, off.b}), kColorStep);
    if (reader.reads_depth) {
      ASSERT_LT(distance_to_arrows(point), kDepthSteps);
      ASSERT_LT(glm::distance(point, hit.point), kDepthSteps);
    }
    // A z rebuilt from x and y of 8 bits says little where the surface is seen from the side.
    const bool rebuilt = reader.name.rfind("godot", 0) == 0;
    if (sample.normal != dvec3(0) && (!rebuilt || facing > .2)) {
      const dvec3 normal = normalize(reader.gltf_from_own * sample.normal);
      ASSERT_LT(std::acos(std::min(1.0, dot(normal, hit.normal))), 2 * kDegree);
      ++turned_;
    }
    if (sample.roughness >= 0) {
      ASSERT_NEAR(sample.roughness, .25, .5 / 15);
    }
    if (sample.metallic >= 0) {
      ASSERT_NEAR(sample.metallic, .75, .5 / 15);
    }
  }

  int covered_ = 0, turned_ = 0;
};

// How these two roll their frames straight from below is not known.
bool open_question(const Case& c, int i, int j) {
  const bool corner = (i == 0 || i == c.grid - 1) && (j == 0 || j == c.grid - 1);
  const std::string name = c.target;
  return c.layout == BakeLayout::kOctahedral && corner && (name == "unreal" || name == "three-tsl");
}

TEST_P(ReadBack, GivesBackTheObject) {
  const Case& c = GetParam();
  const Consumer& reader = consumer::named(c.target);
  const Baked bake = baked_arrows(c.target, c.layout, c.grid, c.tile);
  for (int j = 0; j < c.grid; ++j) {
    for (int i = 0; i < c.grid; ++i) {
      if (!open_question(c, i, j)) check_frame(reader, bake, i, j);
      if (HasFatalFailure()) return;
    }
  }
  EXPECT_GT(covered_, c.grid * c.grid * c.tile * c.tile / 20);
  EXPECT_EQ(turned_ > covered_ / 2, std::string(c.target) != "three-tsl");
}

TEST_P(ReadBack, HasTheSizesItSays) {
  const Case& c = GetParam();
  const Baked bake = baked_arrows(c.target, c.layout, c.grid, c.tile);
  ASSERT_EQ(bake.files.maps.size(), bake.files.images.size() + bake.files.binaries.size());
  for (const auto& image : bake.files.images) {
    EXPECT_EQ(image.width, c.grid * c.tile);
    EXPECT_EQ(image.height, c.grid * c.tile);
    EXPECT_EQ(image.texels.size(), std::size_t(image.width) * image.height * image.channels);
  }
  for (const auto& facts : bake.files.maps) {
    EXPECT_EQ(facts.channels.size(), facts.background.size());
  }
}

constexpr auto kHemi = BakeLayout::kHemi;
constexpr auto kWhole = BakeLayout::kOctahedral;

// Even grids; odd ones, with a frame straight from above; and ones fine enough that a consumer's
// rule for the pole holds for more frames than that.
INSTANTIATE_TEST_SUITE_P(
    Targets, ReadBack,
    testing::Values(Case{"generic", kHemi, 6, 40}, Case{"generic", kHemi, 5, 40},
                    Case{"generic", kWhole, 6, 40}, Case{"generic", BakeLayout::kRing, 4, 40},
                    Case{"three", kHemi, 6, 40}, Case{"three", kHemi, 5, 40},
                    Case{"three", kHemi, 28, 12}, Case{"three-tsl", kHemi, 5, 40},
                    Case{"three-tsl", kHemi, 6, 40}, Case{"three-tsl", kWhole, 5, 40},
                    Case{"godot4", kHemi, 6, 40}, Case{"godot4", kHemi, 5, 40},
                    Case{"godot4", kHemi, 28, 12}, Case{"godot4", kWhole, 6, 40},
                    Case{"godot3", kHemi, 6, 40}, Case{"godot3", kWhole, 5, 40},
                    Case{"unity-imp", kHemi, 6, 40}, Case{"unity-imp", kHemi, 12, 32},
                    Case{"unreal", kHemi, 6, 40}, Case{"unreal", kHemi, 5, 40},
                    Case{"unreal", kWhole, 6, 40}, Case{"boimp", kHemi, 6, 40},
                    Case{"boimp", kHemi, 12, 24}, Case{"boimp", kWhole, 6, 40},
                    Case{"boimp", BakeLayout::kRing, 4, 40}),
    [](const auto& info) {
      std::string name = std::string(info.param.target) + "_" +
                         std::string(name_of(info.param.layout)) + "_" +
                         std::to_string(info.param.grid);
      for (char& c : name) c = c == '-' ? '_' : c;
      return name;
    });

}  // namespace
}  // namespace mirage
