// Another implementation of OpenGL: server and viewer draw on Mesa's softpipe what they draw on its
// usual renderer. softpipe shares no rasterizer, sampler or shader compiler with it.

#include <OpenImageIO/imageio.h>
#include <gtest/gtest.h>

#include <optional>

#include "protocol/quality/flip.h"
#include "tests/support/process.h"

namespace mirage::test {
namespace {

constexpr const char* kScene = "builtin:city?blocks=1";
constexpr double kMostApart = 0.02;

struct Picture {
  std::uint32_t width = 0, height = 0;
  std::vector<std::uint8_t> rgba;
  ImageView view() const { return {width, height, rgba.data()}; }
};

std::optional<Picture> read_png(const std::string& file) {
  const auto in = OIIO::ImageInput::open(file);
  if (!in) return std::nullopt;
  const OIIO::ImageSpec& spec = in->spec();
  Picture out{static_cast<std::uint32_t>(spec.width), static_cast<std::uint32_t>(spec.height), {}};
  out.rgba.assign(spec.image_pixels() * 4, 255);
  if (!in->read_image(0, 0, 0, spec.nchannels, OIIO::TypeDesc::UINT8, out.rgba.data(), 4)) {
    return std::nullopt;
  }
  return out;
}

bool has_softpipe() {
  const Finished devices =
      run({"/usr/bin/env", "GALLIUM_DRIVER=softpipe", binary("mirage-server"), "--list-devices"});
  return devices.output.find("softpipe, OpenGL 3.3") != std::string::npos;
}

// Returns the last frame of a still eye, with shadows.
std::optional<Picture> rest(const std::string& environment) {
  const Server server(kScene, {"--shadows", "on"}, {environment});
  EXPECT_TRUE(server.ready()) << server.log();
  const std::string folder = scratch_folder();
  const Finished done =
      run({"/usr/bin/env", environment, binary("mirage-view"), server.url(), "--virtual-time",
           "--offscreen", "128x72", "--frames", "60", "--fps", "5", "--frame-ms", "0", "--msaa",
           "1", "--path", "builtin:still", "--out", folder},
          300);
  EXPECT_EQ(done.exit_code, 0) << done.output;
  return read_png(folder + "/frame_00059.png");
}

TEST(Softpipe, DrawsTheSamePicture) {
  if (!has_softpipe()) GTEST_SKIP() << "this OpenGL has no softpipe";
  const std::optional<Picture> usual = rest("GALLIUM_DRIVER="),
                               soft = rest("GALLIUM_DRIVER=softpipe");
  ASSERT_TRUE(usual && soft);
  const std::optional<FlipMap> map = flip_map(usual->view(), soft->view());
  ASSERT_TRUE(map);
  const double mean = flip_mean(*map).value_or(1);
  std::printf("FLIP %.4f\n", mean);
  EXPECT_LE(mean, kMostApart);
}

}  // namespace
}  // namespace mirage::test
