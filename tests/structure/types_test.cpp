// The structure of the code: each type of a namespace is defined in one header, and each constant
// of a folder once.
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <map>
#include <regex>
#include <set>
#include <sstream>
#include <string>
#include <vector>

namespace mirage::test {
namespace {

namespace fs = std::filesystem;

/// Returns the types that a header defines at namespace level, each with its namespace before it.
std::vector<std::string> types_of(std::istream& text) {
  static const std::regex opens(R"(^namespace ([A-Za-z_:]+) \{)");
  static const std::regex defines(
      R"(^(?:struct|class|enum class|union) ([A-Za-z_0-9]+)(?: final)?(?: ?:[^;]*)? ?\{)");
  std::vector<std::string> out;
  std::string space;
  std::smatch match;
  for (std::string line; std::getline(text, line);) {
    if (std::regex_search(line, match, opens)) space = match[1];
    if (std::regex_search(line, match, defines)) out.push_back(space + "::" + match[1].str());
  }
  return out;
}

std::map<std::string, std::vector<std::string>> headers_by_type(const fs::path& root) {
  std::map<std::string, std::vector<std::string>> out;
  for (const char* part : {"protocol", "modules", "shaders", "server", "client", "tests"}) {
    for (const auto& entry : fs::recursive_directory_iterator(root / part)) {
      if (entry.path().extension() != ".h") continue;
      std::ifstream text(entry.path());
      for (const std::string& type : types_of(text)) {
        out[type].push_back(fs::relative(entry.path(), root).string());
      }
    }
  }
  return out;
}

/// Returns the constants that a file defines outside of functions and types.
std::set<std::string> constants_of(std::istream& text) {
  static const std::regex defines(
      R"(^(?:inline |static )?(?:constexpr|const) [^(={]*?\b(k[A-Z]\w*)\b)");
  std::set<std::string> out;
  std::smatch match;
  for (std::string line; std::getline(text, line);) {
    if (std::regex_search(line, match, defines)) out.insert(match[1]);
  }
  return out;
}

// Two types of one name in one program are undefined behaviour, and a reader finds the wrong one.
TEST(Structure, EachTypeIsDefinedInOneHeader) {
  const auto headers = headers_by_type(MIRAGE_SOURCE_DIR);
  EXPECT_GT(headers.size(), 300u) << "too few types were found to say anything";
  for (const auto& [type, files] : headers) {
    EXPECT_EQ(files.size(), 1u) << type << " in " << ::testing::PrintToString(files);
  }
}

// Continuous integration compiles the files of a folder as one, where a second constant of a name
// is an error that no other build shows.
TEST(Structure, ShippedFilesOfOneFolderShareNoNameOfAConstant) {
  std::map<std::string, std::vector<std::string>> files_by_constant;
  const fs::path root = MIRAGE_SOURCE_DIR;
  for (const char* part : {"protocol", "modules", "shaders", "server", "client"}) {
    for (const auto& entry : fs::recursive_directory_iterator(root / part)) {
      if (entry.path().extension() != ".cpp") continue;
      const std::string folder = fs::relative(entry.path().parent_path(), root).string();
      std::ifstream text(entry.path());
      for (const std::string& constant : constants_of(text)) {
        files_by_constant[folder + ": " + constant].push_back(entry.path().filename().string());
      }
    }
  }
  EXPECT_GT(files_by_constant.size(), 500u) << "too few constants were found to say anything";
  for (const auto& [constant, files] : files_by_constant) {
    EXPECT_EQ(files.size(), 1u) << constant << " in " << ::testing::PrintToString(files);
  }
}

TEST(Structure, ConstantsAreFoundOutsideOfFunctions) {
  std::istringstream text(
      "constexpr double kOne = 1;\nconst std::vector<int> kTwo = {1};\n  constexpr int kInner = "
      "2;\n"
      "constexpr GLenum kThree[] = {kOne};\nconst Thing& make(int kFour);\n");
  EXPECT_EQ(constants_of(text), (std::set<std::string>{"kOne", "kTwo", "kThree"}));
}

TEST(Structure, TypesAreFoundWithTheirNamespace) {
  std::istringstream text(
      "namespace mirage {\nstruct One;\nstruct Two {\n  struct Inner {\n};\n"
      "class Three final : public Two {\n}  // namespace mirage\nnamespace mirage::gl {\n"
      "enum class Four : int { kA };\n");
  EXPECT_EQ(types_of(text),
            (std::vector<std::string>{"mirage::Two", "mirage::Three", "mirage::gl::Four"}));
}

}  // namespace
}  // namespace mirage::test
