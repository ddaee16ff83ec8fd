// Impostor files: the bytes, and what the depth in them is worth.
#include "server/tile/impostor_file.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstring>

#include "protocol/codec/color_codec.h"
#include "protocol/codec/image_codec.h"

namespace mirage::test {
namespace {

template <typename T>
T read_at(const Bytes& bytes, std::size_t at) {
  T out{};
  std::memcpy(&out, &bytes.at(at), sizeof(out));
  return out;
}

std::string name_at(const Bytes& bytes, std::size_t at) {
  return {bytes.begin() + static_cast<std::ptrdiff_t>(at),
          bytes.begin() + static_cast<std::ptrdiff_t>(at + 4)};
}

/// A picture 10 x 6 px: a wall 2 to 4 m away, farther to the right, and sky in the upper cells.
struct Wall {
  Camera camera;
  SceneFrame frame;
  Wall() {
    camera.width = 10;
    camera.height = 6;
    camera.pose = look_at({1, 2, 3}, {1, 2, -9});
    for (std::uint32_t y = 0; y < camera.height; ++y) {
      for (std::uint32_t x = 0; x < camera.width; ++x) {
        frame.depth.push_back(y < 4 ? 0.0f : 2.0f + 2.0f * static_cast<float>(x) / 9.0f);
      }
    }
  }
};

TEST(ImpostorFile, TheChunkSaysWhereTheSurfacesAre) {
  const Wall wall;
  const Bytes chunk = impostor_chunk(wall.camera, wall.frame).take();
  EXPECT_EQ(name_at(chunk, 0), "MIRI");
  const auto bytes = read_at<std::uint32_t>(chunk, 4);
  EXPECT_EQ(chunk.size(), 8 + bytes + bytes % 2);
  EXPECT_EQ(read_at<std::uint32_t>(chunk, 8), 1u);
  EXPECT_FLOAT_EQ(read_at<float>(chunk, 12), static_cast<float>(wall.camera.fov_y));
  const float near = read_at<float>(chunk, 16), far = read_at<float>(chunk, 20);
  EXPECT_FLOAT_EQ(read_at<float>(chunk, 36), wall.camera.pose.rotation.w);
  EXPECT_EQ(read_at<double>(chunk, 40), 1);
  EXPECT_EQ(read_at<double>(chunk, 56), 3);
  const Image depth =
      decode_image(&chunk.at(64), bytes - 56, {3, 2}, false).take();  // cells of 4 px, cut
  const auto metres = [&](int x, int y) {
    const double t = depth.rgba[static_cast<std::size_t>(4 * (3 * y + x))] / 255.0;
    return 1 / (1 / far + t * (1 / near - 1 / far));
  };
  EXPECT_NEAR(metres(0, 1), 2, 0.02) << "the nearest of the cell";
  EXPECT_NEAR(metres(1, 1), 2 + 2 * 4 / 9.0, 0.02);
  EXPECT_NEAR(metres(2, 1), 2 + 2 * 8 / 9.0, 0.02);
  for (int x = 0; x < 3; ++x) EXPECT_EQ(depth.rgba[static_cast<std::size_t>(4 * x)], 0) << "sky";
}

TEST(ImpostorFile, AnEmptySkyHasADepthThatIsANumber) {
  Wall wall;
  std::fill(wall.frame.depth.begin(), wall.frame.depth.end(), 0.0f);
  const Bytes chunk = impostor_chunk(wall.camera, wall.frame).take();
  EXPECT_TRUE(std::isfinite(read_at<float>(chunk, 16)));
  EXPECT_GT(read_at<float>(chunk, 20), 0);
}

TEST(ImpostorFile, WhatShowsWebpShowsIt) {
  const Wall wall;
  const ColorBytes colors(4 * 60, 200);
  const Bytes webp = encode_webp_colors(colors, 10, 6);
  const Bytes chunk = impostor_chunk(wall.camera, wall.frame).take();
  const Bytes file = with_chunk(webp, wall.camera, chunk).take();
  EXPECT_EQ(read_at<std::uint32_t>(file, 4) + 8, file.size());
  EXPECT_EQ(name_at(file, 12), "VP8X");
  EXPECT_EQ(name_at(file, file.size() - chunk.size()), "MIRI");
  const auto shown = decode_webp_colors(file.data(), file.size(), 10, 6);
  ASSERT_TRUE(shown) << shown.error().text;
  EXPECT_EQ(*shown, *decode_webp_colors(webp.data(), webp.size(), 10, 6));
  EXPECT_FALSE(with_chunk(Bytes(100, 'x'), wall.camera, chunk));
  EXPECT_FALSE(with_chunk({}, wall.camera, chunk));
}

}  // namespace
}  // namespace mirage::test
