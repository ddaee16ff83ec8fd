// Reasons why no card draws: each fault is named, with its cure.
#include "shaders/gl/missing_gpu.h"

#include <gtest/gtest.h>

namespace mirage::test {
namespace {

const gl::EglVendor kMesa{"50_mesa.json", "libEGL_mesa.so.0", ""};
const gl::EglVendor kNvidia{"10_nvidia.json", "libEGL_nvidia.so.0", ""};

/// Returns the only reason, with its hint.
std::string reason(const gl::GpuFacts& facts) {
  const std::vector<Error> all = gl::why_no_gpu(facts);
  EXPECT_EQ(all.size(), 1u) << (all.empty() ? "none" : all.back().text);
  return all.empty() ? "" : all.front().line();
}

bool has(const std::string& text, const std::string& part) {
  return text.find(part) != std::string::npos;
}

gl::GpuFacts with_nvidia() {
  gl::GpuFacts facts;
  facts.nvidia_nodes = true;
  facts.vendors = {kNvidia, kMesa};
  return facts;
}

TEST(MissingGpu, NoCardIsVisible) {
  gl::GpuFacts facts;
  facts.vendors = {kMesa};
  EXPECT_TRUE(has(reason(facts), "no card is visible")) << reason(facts);
  EXPECT_EQ(gl::why_no_gpu(facts).front().id, ErrorId::kGraphicsDevice);
}

TEST(MissingGpu, TheContainerLacksGraphics) {
  gl::GpuFacts facts = with_nvidia();
  facts.nvidia_capabilities = "compute,utility";
  EXPECT_TRUE(has(reason(facts), "lacks graphics")) << reason(facts);
  EXPECT_TRUE(has(reason(facts), "NVIDIA_DRIVER_CAPABILITIES=graphics,utility"));
  for (const char* good : {"all", "graphics", "utility,graphics"}) {
    facts.nvidia_capabilities = good;
    EXPECT_FALSE(has(reason(facts), "lacks graphics")) << good;
  }
}

TEST(MissingGpu, OnlyMesaIsInstalled) {
  gl::GpuFacts facts = with_nvidia();
  facts.vendors = {kMesa};
  EXPECT_TRUE(has(reason(facts), "no EGL vendor file of NVIDIA (found: 50_mesa.json)"));
}

TEST(MissingGpu, TheDriverDoesNotLoad) {
  gl::GpuFacts facts = with_nvidia();
  facts.vendors[0].load_error = "libnvidia-glsi.so.550 is missing";
  EXPECT_TRUE(has(reason(facts), "10_nvidia.json")) << reason(facts);
  EXPECT_TRUE(has(reason(facts), "libnvidia-glsi.so.550 is missing")) << reason(facts);
}

TEST(MissingGpu, TheUserMayNotOpenTheCard) {
  gl::GpuFacts facts;
  facts.vendors = {kMesa};
  facts.render_nodes = {"/dev/dri/renderD128", "/dev/dri/renderD129"};
  facts.closed_nodes = {"/dev/dri/renderD129"};
  EXPECT_TRUE(has(reason(facts), "may not open /dev/dri/renderD129")) << reason(facts);
}

TEST(MissingGpu, NothingIsInstalled) {
  gl::GpuFacts facts;
  facts.render_nodes = {"/dev/dri/renderD128"};
  EXPECT_TRUE(has(reason(facts), "no EGL vendor file in")) << reason(facts);
}

TEST(MissingGpu, ADriverThatDrawsNothingIsNamed) {
  EXPECT_TRUE(has(reason(with_nvidia()), "10_nvidia.json, 50_mesa.json"));
}

}  // namespace
}  // namespace mirage::test
