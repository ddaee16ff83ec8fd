#include "server/bake/boimp_file.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <map>

#include "modules/image_library.h"
#include "protocol/output/zip.h"

namespace mirage {
namespace {

using Bytes8 = std::vector<std::uint8_t>;

constexpr std::size_t kTexelBytes = sizeof(BoimpTexel);

std::uint32_t bits(float value, int shift, int count) {
  const float most = float((1u << count) - 1);
  return std::uint32_t(std::clamp(value, 0.0f, 1.0f) * most + .5f) << shift;
}

float sign_of(float v) { return v < 0 ? -1.0f : 1.0f; }

// Returns x and z of a direction in the square of the whole octahedron around +y, 0 to 1.
glm::vec2 octahedron(glm::vec3 n) {
  const float sum = std::abs(n.x) + std::abs(n.y) + std::abs(n.z);
  if (!(sum > 0)) return {.5f, .5f};
  n /= sum;
  glm::vec2 p(n.x, n.z);
  if (n.y < 0) {
    p = {sign_of(n.x) * (1 - std::abs(n.z)), sign_of(n.z) * (1 - std::abs(n.x))};
  }
  return p * .5f + .5f;
}

// The texels of all frames, or of the same part of each. Frame (0, 0) is at the top left.
struct Sheet {
  int grid = 0, left = 0, top = 0, width = 0, height = 0;  // the part of a frame
  std::vector<BoimpTexel> texels;

  int columns() const { return grid * width; }
  int rows() const { return grid * height; }
};

Sheet whole_sheet(const BakeMaster& master, const TargetFacts& target) {
  Sheet sheet{master.grid, 0, 0, master.tile, master.tile, {}};
  sheet.texels.resize(master.texels());
  for (int j = 0; j < master.grid; ++j) {
    for (int i = 0; i < master.grid; ++i) {
      const FrameTexels frame(master, target, master.first(i, j));
      for (int t = 0; t < master.tile * master.tile; ++t) {
        const std::size_t row = std::size_t(j) * master.tile + t / master.tile;
        const std::size_t at =
            row * sheet.columns() + std::size_t(i) * master.tile + t % master.tile;
        sheet.texels[at] = boimp_texel(frame.at(t));
      }
    }
  }
  return sheet;
}

// Leaves out the rows and columns at the edge that are empty in every frame.
Sheet trimmed(const Sheet& whole) {
  const int tile = whole.width;
  int left = tile, top = tile, right = -1, bottom = -1;
  for (std::size_t at = 0; at < whole.texels.size(); ++at) {
    if (whole.texels[at][0] == 0) continue;
    const int x = int(at % whole.columns()) % tile, y = int(at / whole.columns()) % tile;
    left = std::min(left, x), right = std::max(right, x);
    top = std::min(top, y), bottom = std::max(bottom, y);
  }
  if (right < 0) left = right = top = bottom = 0;  // a file needs one texel
  Sheet out{whole.grid, left, top, right - left + 1, bottom - top + 1, {}};
  out.texels.reserve(std::size_t(out.columns()) * out.rows());
  for (int y = 0; y < out.rows(); ++y) {
    const std::size_t row = std::size_t(y / out.height) * tile + top + y % out.height;
    for (int x = 0; x < out.columns(); ++x) {
      out.texels.push_back(
          whole.texels[row * whole.columns() + x / out.width * tile + left + x % out.width]);
    }
  }
  return out;
}

void put(Bytes8& out, std::uint64_t value, int bytes) {
  for (int b = 0; b < bytes; ++b) out.push_back(std::uint8_t(value >> (8 * b)));
}

Result<ZipEntry> png(const char* name, int width, int height, const Bytes8& rgba) {
  const auto library = image_library();
  if (!library) return library.error();
  auto bytes = (*library)->encode(name, {width, height, 4, rgba.data()}, "none:6");
  if (!bytes) return bytes.error();
  return ZipEntry{name, bytes.take()};
}

// Each different texel once, and which of them each place shows.
struct Palette {
  std::vector<BoimpTexel> texels;  // filled up with zeros to width * height
  int width = 0, height = 0;
  std::vector<std::uint32_t> numbers;

  // Numbers of 16 bits reach all texels.
  bool small() const { return width * height < 65536; }
  std::size_t bytes() const {
    return texels.size() * kTexelBytes + numbers.size() * (small() ? 2 : 4);
  }
};

Palette palette_of(const Sheet& sheet) {
  std::map<BoimpTexel, std::uint32_t> known;
  for (const auto& texel : sheet.texels) known.emplace(texel, 0);
  Palette out;
  for (auto& [texel, number] : known) {
    number = std::uint32_t(out.texels.size());
    out.texels.push_back(texel);
  }
  const int count = int(known.size());
  out.width = int(std::ceil(std::sqrt(double(count))));
  out.height = (count + out.width - 1) / out.width;
  out.texels.resize(std::size_t(out.width) * out.height, BoimpTexel{0, 0});
  out.numbers.reserve(sheet.texels.size());
  for (const auto& texel : sheet.texels) out.numbers.push_back(known.at(texel));
  return out;
}

Bytes8 bytes_of(const std::vector<BoimpTexel>& texels) {
  Bytes8 out;
  out.reserve(texels.size() * kTexelBytes);
  for (const auto& texel : texels) put(out, texel[0], 4), put(out, texel[1], 4);
  return out;
}

// A row of an odd number of 16-bit numbers ends with a 0.
Bytes8 bytes_of(const Palette& palette, int columns) {
  Bytes8 out;
  for (std::size_t i = 0; i < palette.numbers.size(); ++i) {
    put(out, palette.numbers[i], palette.small() ? 2 : 4);
    const bool row_ends = (i + 1) % columns == 0;
    if (palette.small() && row_ends && columns % 2 == 1) put(out, 0, 2);
  }
  return out;
}

Result<std::vector<ZipEntry>> pictures(const Sheet& sheet) {
  const Palette palette = palette_of(sheet);
  std::vector<ZipEntry> out;
  if (palette.bytes() >= sheet.texels.size() * kTexelBytes) {
    auto texture = png("texture.png", sheet.columns() * 2, sheet.rows(), bytes_of(sheet.texels));
    if (!texture) return texture.error();
    out.push_back(texture.take());
    return out;
  }
  auto texels = png("pixels.png", palette.width * 2, palette.height, bytes_of(palette.texels));
  if (!texels) return texels.error();
  const int width = palette.small() ? (sheet.columns() + 1) / 2 : sheet.columns();
  auto numbers = png("indices.png", width, sheet.rows(), bytes_of(palette, sheet.columns()));
  if (!numbers) return numbers.error();
  out.push_back(texels.take());
  out.push_back(numbers.take());
  return out;
}

std::string settings_of(const BakeMaster& master, const Sheet& sheet) {
  const char* mode = master.layout == BakeLayout::kHemi         ? "hemispherical"
                     : master.layout == BakeLayout::kOctahedral ? "spherical"
                                                                : "Horizontal";
  char radius[32];
  std::snprintf(radius, sizeof radius, "%.9g", master.radius);
  std::string out = std::to_string(master.grid) + " " + radius + " " + mode;
  for (const int n : {master.tile, sheet.left, sheet.top, sheet.width, sheet.height}) {
    out += " " + std::to_string(n);
  }
  return out;
}

}  // namespace

BoimpTexel boimp_texel(const FrameTexel& texel) {
  if (texel.coverage < .5f) return {0, 0};
  const glm::vec2 normal = octahedron(texel.normal);
  return {bits(texel.color.r, 0, 5) | bits(texel.color.g, 5, 5) | bits(texel.color.b, 10, 5) |
              bits(texel.coverage, 15, 5) | bits(texel.orm.g, 20, 4) | bits(texel.orm.b, 24, 4),
          bits(normal.x, 0, 12) | bits(normal.y, 12, 12) | bits(texel.depth * .5f + .5f, 24, 8)};
}

std::vector<std::string> boimp_channels() {
  return {"word 0, bits 0-4: red",
          "word 0, bits 5-9: green",
          "word 0, bits 10-14: blue",
          "word 0, bits 15-19: coverage",
          "word 0, bits 20-23: roughness",
          "word 0, bits 24-27: metallic",
          "word 0, bits 28-31: 0",
          "word 1, bits 0-11: octahedral n, x",
          "word 1, bits 12-23: octahedral n, z",
          "word 1, bits 24-31: .5 + s / (2 * radius)"};
}

Result<std::vector<std::uint8_t>> boimp_file(const BakeMaster& master, const TargetFacts& target) {
  const Sheet sheet = trimmed(whole_sheet(master, target));
  auto entries = pictures(sheet);
  if (!entries) return entries.error();
  const std::string settings = settings_of(master, sheet);
  entries->push_back({"settings.txt", {settings.begin(), settings.end()}});
  return stored_zip(*entries);
}

}  // namespace mirage
