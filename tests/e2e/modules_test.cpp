// Modules: programs need no library of a window system or a video card at their start, and say
// clearly when a module is missing.
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <regex>

#include "tests/support/process.h"

namespace mirage::test {
namespace {

namespace fs = std::filesystem;

std::string helmet() { return shared_folder() + "/assets/objects/flight_helmet.glb"; }

/// A copy of the server in a folder where it finds no module.
struct Alone : ::testing::Test {
  Alone() {
    fs::create_directories(folder);
    fs::copy_file(binary("mirage-server"), folder + "/mirage-server",
                  fs::copy_options::overwrite_existing);
  }
  ~Alone() override { fs::remove_all(folder); }
  Finished explain(const std::string& scene) const {
    return run({folder + "/mirage-server", "--explain", scene});
  }
  void expect_refused(const std::string& why) const {
    const Finished refused = explain(helmet());
    EXPECT_EQ(refused.exit_code, 1) << refused.output;
    EXPECT_NE(refused.output.find("error module: "), std::string::npos) << refused.output;
    EXPECT_NE(refused.output.find(why), std::string::npos) << refused.output;
    EXPECT_NE(refused.output.find("(hint: install "), std::string::npos) << refused.output;
  }
  const std::string folder = scratch_folder() + "/alone";
  const std::string module = folder + "/libmirage_images.so";
};

TEST_F(Alone, ASceneWithoutImagesNeedsNoModule) {
  const Finished done = explain("builtin:knot");
  EXPECT_EQ(done.exit_code, 0) << done.output;
}

TEST_F(Alone, AMissingModuleIsNamed) { expect_refused("libmirage_images.so is missing"); }

TEST_F(Alone, AModuleThatDoesNotLoadIsNamed) {
  std::ofstream(module) << "no library";
  expect_refused("cannot load " + module);
}

TEST_F(Alone, AModuleOfAnotherBuildIsNamed) {
  fs::copy_file("/usr/lib/x86_64-linux-gnu/libz.so.1", module);
  expect_refused("is of another build");
}

TEST(Modules, ProgramsStartWithoutAWindowSystem) {
  const std::regex window(
      "libX[A-Z1][A-Za-z0-9-]*|libxcb[a-z0-9-]*|libdrm[a-z0-9_-]*|libva[.-]|"
      "libwayland|libOpenImageIO|libavcodec");
  for (const char* program : {"mirage-server", "mirage-load", "mirage-report", "mirage-token",
                              "mirage-sheet", "mirage-bench", "mirage-extreme"}) {
    const Finished libraries = run({"/usr/bin/ldd", binary(program)});
    ASSERT_EQ(libraries.exit_code, 0) << program << "\n" << libraries.output;
    ASSERT_NE(libraries.output.find("libc.so"), std::string::npos) << libraries.output;
    std::smatch found;
    EXPECT_FALSE(std::regex_search(libraries.output, found, window)) << program << ": " << found[0];
  }
  // The viewer opens a window. It shows that the expression finds such libraries.
  const Finished viewer = run({"/usr/bin/ldd", binary("mirage-view")});
  EXPECT_TRUE(std::regex_search(viewer.output, window)) << viewer.output;
}

}  // namespace
}  // namespace mirage::test
