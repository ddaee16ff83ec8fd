// The top level of the project: a stray folder was once committed there unseen.
#include <gtest/gtest.h>

#include <filesystem>
#include <set>
#include <string>

namespace mirage::test {
namespace {

TEST(Structure, TopLevelHoldsOnlyWhatIsNamedHere) {
  const std::set<std::string> named = {
      "ARCHITECTURE.md", "CHANGELOG.md", "CMakeLists.txt", "CMakePresets.json",
      "CONTRIBUTING.md", "LICENSE",      "README.md",      "build",
      "client",          "cmake",        "docs",           "examples",
      "modules",         "out",          "packaging",      "protocol",
      "scripts",         "server",       "shaders",        "tests"};
  for (const auto& entry : std::filesystem::directory_iterator(MIRAGE_SOURCE_DIR)) {
    const std::string name = entry.path().filename().string();
    if (name[0] == '.') continue;  // settings of editors and tools
    EXPECT_TRUE(named.count(name)) << name << " is no part of the project";
  }
}

}  // namespace
}  // namespace mirage::test
