// Clips and variants that viewers choose, each for itself, from one server.
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <thread>

#include "tests/support/colored_box.h"
#include "tests/support/process.h"

namespace mirage::test {
namespace {

namespace fs = std::filesystem;

/// A red box with a green variant, and two clips: in one it stays, in the other it is out of sight.
std::string scene(const fs::path& folder) {
  Builder b = box_builder(kRed);
  b.doc["materials"].push_back({{"pbrMetallicRoughness", {{"baseColorFactor", kGreen}}}});
  b.primitive()["extensions"]["KHR_materials_variants"]["mappings"] = {
      {{"material", 1}, {"variants", {0}}}};
  b.doc["extensions"]["KHR_materials_variants"]["variants"] = {{{"name", "leaf green"}}};
  b.doc["extensionsUsed"] = {"KHR_materials_variants"};
  const int times = b.accessor(std::vector<float>{0, 1000}, "SCALAR", 5126, 1);
  const auto clip = [&](const std::string& name, const std::vector<float>& places) {
    b.doc["animations"].push_back(
        {{"name", name},
         {"samplers", {{{"input", times}, {"output", b.vec3(places)}}}},
         {"channels", {{{"sampler", 0}, {"target", {{"node", 0}, {"path", "translation"}}}}}}});
  };
  clip("stays", {0, 0, 0, 0.01f, 0, 0});
  clip("gone", {0, -1000, 0, 0, -1001, 0});
  const fs::path file = folder / "box.glb";
  std::ofstream(file, std::ios::binary) << file_of(b);
  return file.string();
}

struct Viewed {
  Finished run;
  char color = '?';  ///< of the last frame
};

Viewed view(const std::string& url, const std::vector<std::string>& options = {}, int frames = 60) {
  const fs::path folder = scratch_folder();
  std::vector<std::string> command = {binary("mirage-view"),
                                      url,
                                      "--offscreen",
                                      "160x90",
                                      "--path",
                                      "#eye=0,0,6&look=0,0,0",
                                      "--fps",
                                      "20",
                                      "--frames",
                                      std::to_string(frames),
                                      "--out",
                                      folder.string()};
  command.insert(command.end(), options.begin(), options.end());
  Viewed out{run(command), '?'};
  const std::string seen = seen_in(folder);
  if (!seen.empty()) out.color = seen.back();
  return out;
}

TEST(Choices, EachViewerSeesWhatItChose) {
  const fs::path folder = scratch_folder();
  const Server server(scene(folder), {});
  ASSERT_TRUE(server.ready()) << server.log();
  EXPECT_EQ(view(server.url()).color, 'r');
  EXPECT_EQ(view(server.url() + "/?variant=leaf%20green").color, 'g') << server.log();
  EXPECT_EQ(view(server.url(), {"--variant", "leaf green", "--clip", "stays"}).color, 'g');
  EXPECT_EQ(view(server.url(), {"--clip", "gone"}).color, '-');
  const Viewed as_served = view(server.url());
  EXPECT_EQ(as_served.color, 'r');
  EXPECT_NE(as_served.run.output.find("clips: stays, gone"), std::string::npos)
      << as_served.run.output;
}

TEST(Choices, WhatASceneDoesNotOfferIsToldAndTheSceneShown) {
  const fs::path folder = scratch_folder();
  const Server server(scene(folder), {});
  ASSERT_TRUE(server.ready()) << server.log();
  const Viewed blue = view(server.url(), {"--variant", "blue"});
  EXPECT_EQ(blue.color, 'r');
  EXPECT_NE(blue.run.output.find("the scene has no variant 'blue'"), std::string::npos)
      << blue.run.output;
  EXPECT_EQ(server.log().find("beside what is served"), std::string::npos) << server.log();
}

TEST(Choices, AServerLimitsThem) {
  const fs::path folder = scratch_folder();
  const std::string file = scene(folder);
  const Server none(file, {"--choices", "0"});
  const Server one(file, {"--choices", "1"});
  ASSERT_TRUE(none.ready() && one.ready()) << none.log() << one.log();
  EXPECT_EQ(view(none.url(), {"--variant", "leaf green"}).color, 'r');
  std::thread looking([&] { EXPECT_EQ(view(one.url(), {"--clip", "stays"}, 400).color, 'r'); });
  EXPECT_TRUE(soon([&] { return one.log().find("shows clip 'stays' too") != std::string::npos; }));
  const Viewed second = view(one.url(), {"--clip", "gone", "--connect-timeout", "2"});
  EXPECT_NE(second.run.exit_code, 0);
  EXPECT_NE(second.run.output.find("as many clips and variants as this server shows at a time"),
            std::string::npos)
      << second.run.output;
  looking.join();
  // Once nobody looks at the first, its room is free.
  EXPECT_EQ(view(one.url(), {"--clip", "gone"}).color, '-') << one.log();
}

TEST(Choices, StrangersHaveNothingLoaded) {
  const fs::path folder = scratch_folder();
  std::ofstream(folder / "tokens") << "a-token-of-twenty-bytes\n";
  std::ofstream(folder / "token") << "a-token-of-twenty-bytes\n";
  const Server server(scene(folder), {"--token-file", (folder / "tokens").string()});
  ASSERT_TRUE(server.ready()) << server.log();
  EXPECT_NE(view(server.url(), {"--clip", "gone"}).run.exit_code, 0);
  EXPECT_EQ(server.log().find("beside what is served"), std::string::npos) << server.log();
  const std::vector<std::string> token = {"--clip", "gone", "--token-file",
                                          (folder / "token").string()};
  EXPECT_EQ(view(server.url(), token).color, '-') << server.log();
}

}  // namespace
}  // namespace mirage::test
