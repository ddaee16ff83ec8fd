#include "tests/server/bake/baked.h"

#include <gtest/gtest.h>

#include <cmath>
#include <map>
#include <sstream>

#include "modules/image_library.h"
#include "tests/server/bake/arrows.h"

namespace mirage {
namespace {

using Bytes8 = std::vector<std::uint8_t>;

consumer::Picture quantised(const BakeImage& image) {
  consumer::Picture out{image.width, image.height, image.channels, {}};
  for (const float v : image.texels) out.bytes.push_back(std::uint8_t(std::lround(v * 255)));
  return out;
}

std::uint32_t little(const Bytes8& bytes, std::size_t at, int count) {
  std::uint32_t out = 0;
  for (int b = count - 1; b >= 0; --b) out = out << 8 | bytes.at(at + b);
  return out;
}

std::map<std::string, Bytes8> unzipped(const Bytes8& zip) {
  std::map<std::string, Bytes8> out;
  const std::size_t end = zip.size() - 22;
  EXPECT_EQ(little(zip, end, 4), 0x06054b50u);
  std::size_t at = little(zip, end + 16, 4);
  for (std::uint32_t n = 0; n < little(zip, end + 10, 2); ++n) {
    EXPECT_EQ(little(zip, at, 4), 0x02014b50u);
    EXPECT_EQ(little(zip, at + 10, 2), 0u) << "compressed";
    const std::uint32_t size = little(zip, at + 24, 4), name = little(zip, at + 28, 2);
    const std::size_t local = little(zip, at + 42, 4);
    EXPECT_EQ(little(zip, local, 4), 0x04034b50u);
    const auto begin = zip.begin() + long(local) + 30 + little(zip, local + 26, 2);
    out[std::string(zip.begin() + long(at) + 46, zip.begin() + long(at) + 46 + name)] =
        Bytes8(begin, begin + size);
    at += 46 + name;
  }
  return out;
}

struct Pixels {
  int width = 0, height = 0;
  Bytes8 bytes;
};

Pixels pixels_of(const Bytes8& png) {
  const auto library = image_library();
  EXPECT_TRUE(library) << library.error().line();
  auto reader = (*library)->open_bytes(png, "a.png");
  EXPECT_TRUE(reader);
  const ImageShape shape = (*reader)->shape();
  EXPECT_EQ(shape.channels, 4);
  Pixels out{shape.width, shape.height, Bytes8(std::size_t(shape.width) * shape.height * 4)};
  EXPECT_TRUE((*reader)->read_rows(0, shape.height, 4, out.bytes.data()));
  return out;
}

// Returns where in `texels` (8 bytes each) the texel of a place is.
std::size_t texel_number(const std::map<std::string, Bytes8>& entries, const Pixels& texels,
                         const Pixels& numbers, int columns, int x, int y) {
  if (entries.count("texture.png")) return std::size_t(y) * columns + x;
  if (texels.width / 2 * texels.height >= 65536) {
    return little(numbers.bytes, (std::size_t(y) * numbers.width + x) * 4, 4);
  }
  const std::uint32_t pair = little(numbers.bytes, (std::size_t(y) * numbers.width + x / 2) * 4, 4);
  return x % 2 ? pair >> 16 : pair & 0xffff;
}

}  // namespace

Boimp read_boimp(const Bytes8& bytes) {
  auto entries = unzipped(bytes);
  Boimp out;
  for (const auto& [name, content] : entries) out.names.push_back(name);
  const Bytes8& text = entries.at("settings.txt");
  out.settings.assign(text.begin(), text.end());
  int grid = 0, tile = 0, left = 0, top = 0, width = 0, height = 0;
  double scale = 0;
  std::string mode;
  std::istringstream(out.settings) >> grid >> scale >> mode >> tile >> left >> top >> width >>
      height;
  const bool indexed = entries.count("pixels.png") > 0;
  const Pixels texels = pixels_of(entries.at(indexed ? "pixels.png" : "texture.png"));
  const Pixels numbers = indexed ? pixels_of(entries.at("indices.png")) : Pixels{};
  const int side = grid * tile;
  consumer::Picture words[2];
  for (auto& word : words) {
    word = {side, side, 4, Bytes8(std::size_t(side) * side * 4)};
  }
  for (int y = 0; y < grid * height; ++y) {
    for (int x = 0; x < grid * width; ++x) {
      const std::size_t from = texel_number(entries, texels, numbers, grid * width, x, y) * 8;
      const std::size_t to = (std::size_t(y / height * tile + top + y % height) * side +
                              x / width * tile + left + x % width) *
                             4;
      for (int b = 0; b < 8; ++b) words[b / 4].bytes.at(to + b % 4) = texels.bytes.at(from + b);
    }
  }
  out.words = {{"word 0", words[0]}, {"word 1", words[1]}};
  return out;
}

Baked baked_arrows(const std::string& name, BakeLayout layout, int grid, int tile) {
  const TargetFacts* target = target_of(name);
  EXPECT_NE(target, nullptr) << name;
  Baked out;
  out.master = arrows_master(layout, grid, tile, target->roll);
  auto files = export_bake(out.master, *target, {.object = "arrows"});
  EXPECT_TRUE(files) << files.error().line();
  out.files = files.take();
  for (const auto& image : out.files.images) out.pictures[image.map] = quantised(image);
  for (const auto& file : out.files.binaries) out.pictures = read_boimp(file.bytes).words;
  return out;
}

}  // namespace mirage
