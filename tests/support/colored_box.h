#pragma once
// A coloured box as a scene file, and the colour that a viewer's frames show of it.

#include <OpenImageIO/imageio.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <filesystem>
#include <functional>
#include <string>
#include <thread>
#include <vector>

#include "tests/support/gltf_builder.h"

namespace mirage::test {

using Color = std::array<double, 4>;
inline constexpr Color kRed = {0.8, 0.02, 0.02, 1}, kGreen = {0.02, 0.8, 0.02, 1};

/// A box of 2 x 2 x 2 in one colour, as a file that can be added to.
inline Builder box_builder(const Color& color) {
  Builder b;
  const std::vector<float> corners = {-1, -1, -1, 1, -1, -1, -1, 1, -1, 1, 1, -1,
                                      -1, -1, 1,  1, -1, 1,  -1, 1, 1,  1, 1, 1};
  const std::vector<std::uint16_t> faces = {0, 2, 1, 1, 2, 3, 4, 5, 6, 5, 7, 6, 0, 1, 4, 1, 5, 4,
                                            2, 6, 3, 3, 6, 7, 0, 4, 2, 2, 4, 6, 1, 3, 5, 3, 7, 5};
  const int positions = b.accessor(corners, "VEC3", 5126, 3);
  const int indices = b.accessor(faces, "SCALAR", 5123, 1);
  b.doc["scene"] = 0;
  b.doc["scenes"] = {{{"nodes", {0}}}};
  b.doc["nodes"] = {{{"mesh", 0}}};
  b.doc["materials"] = {
      {{"pbrMetallicRoughness", {{"baseColorFactor", color}}}, {"doubleSided", true}}};
  b.doc["meshes"] = {
      {{"primitives",
        {{{"attributes", {{"POSITION", positions}}}, {"indices", indices}, {"material", 0}}}}}};
  return b;
}

inline std::string file_of(Builder& b) {
  b.doc["buffers"] = {{{"byteLength", b.bin.size()}}};
  return make_glb(b.doc.dump(), b.bin);
}

inline std::string box(const Color& color) {
  Builder b = box_builder(color);
  return file_of(b);
}

/// Waits until something holds; false: it does not within that time.
inline bool soon(const std::function<bool()>& what, double seconds = 20) {
  const auto until = std::chrono::steady_clock::now() + std::chrono::duration<double>(seconds);
  while (!what()) {
    if (std::chrono::steady_clock::now() > until) return false;
    std::this_thread::sleep_for(std::chrono::milliseconds(50));
  }
  return true;
}

/// Returns the colour in the middle of a frame: 'r', 'g', or '-' for neither.
inline char seen(const std::filesystem::path& png) {
  const auto in = OIIO::ImageInput::open(png.string());
  if (!in) return '?';
  const OIIO::ImageSpec& spec = in->spec();
  std::vector<std::uint8_t> pixels(spec.image_pixels() * static_cast<std::size_t>(spec.nchannels));
  if (!in->read_image(0, 0, 0, spec.nchannels, OIIO::TypeDesc::UINT8, pixels.data())) return '?';
  const std::size_t middle = (pixels.size() / static_cast<std::size_t>(spec.nchannels) +
                              static_cast<std::size_t>(spec.width)) /
                             2;
  const std::uint8_t* pixel = &pixels[middle * static_cast<std::size_t>(spec.nchannels)];
  if (pixel[0] > 2 * pixel[1] && pixel[0] > 2 * pixel[2]) return 'r';
  if (pixel[1] > 2 * pixel[0] && pixel[1] > 2 * pixel[2]) return 'g';
  return '-';
}
/// Returns the colours of all frames in a folder, in order.
inline std::string seen_in(const std::filesystem::path& folder) {
  std::vector<std::filesystem::path> frames(std::filesystem::directory_iterator(folder), {});
  std::sort(frames.begin(), frames.end());
  std::string out;
  for (const std::filesystem::path& frame : frames) out += seen(frame);
  return out;
}

}  // namespace mirage::test
