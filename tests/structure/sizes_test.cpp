// Sizes of functions and types. The code is formatted, so lines tell: a function ends with a brace
// in the first column, and members are indented by two.
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <regex>
#include <string>
#include <vector>

namespace mirage::test {
namespace {

namespace fs = std::filesystem;
using Lines = std::vector<std::string>;

struct Size {
  int size = 0;
  std::string what;
  bool operator<(const Size& o) const { return size > o.size; }
};

Lines lines_of(const fs::path& file) {
  std::ifstream in(file);
  Lines out;
  for (std::string line; std::getline(in, line);) out.push_back(line);
  return out;
}

bool begins(const std::string& line, const char* text) { return line.rfind(text, 0) == 0; }

/// Returns the lines of each function, with its signature.
std::vector<Size> functions_in(const Lines& lines) {
  std::vector<Size> out;
  std::size_t start = 0;
  for (std::size_t i = 0; i < lines.size(); ++i) {
    const std::string& line = lines[i];
    const bool indented = line.empty() || line[0] == ' ' || line[0] == '}' || line[0] == '#' ||
                          line[0] == '/' || line[0] == ')' || begins(line, "template ");
    if (!indented &&
        (i == 0 || lines[i - 1].empty() || lines[i - 1][0] == '}' || lines[i - 1][0] == '/' ||
         lines[i - 1][0] == '#' || lines[i - 1].back() == ';' || lines[i - 1].back() == '{' ||
         begins(lines[i - 1], "template "))) {
      start = i;
    }
    const std::string& first = lines[start];
    const std::string declared = first.substr(0, first.find('('));
    const bool function = declared != first && declared.find('=') == std::string::npos;
    if (line == "}" && function) {
      out.push_back({static_cast<int>(i - start + 1), first.substr(0, first.find('('))});
    }
  }
  return out;
}

/// Returns the data members of each class and struct.
std::vector<Size> types_in(const Lines& lines) {
  static const std::regex type("^(?:class|struct) (\\w+)[^;]*\\{$");
  static const std::regex none(
      "^  (?:using|static|friend|typedef|template|return|enum|struct|class|explicit|virtual) .*");
  std::vector<Size> out;
  for (std::size_t i = 0; i < lines.size(); ++i) {
    std::smatch name;
    if (!std::regex_match(lines[i], name, type)) continue;
    int members = 0;
    for (++i; i < lines.size() && lines[i] != "};"; ++i) {
      std::string line = lines[i];
      // A declaration over several lines.
      while (begins(line, "  ") && line[2] != ' ' && line.find('(') == std::string::npos &&
             (line.back() == ',' || line.back() == '>') && i + 1 < lines.size()) {
        ++i;
        line += lines[i].substr(std::min<std::size_t>(lines[i].size(), 5));
      }
      if (!begins(line, "  ") || line.size() < 4 || line[2] == ' ' || line[2] == '}') continue;
      std::string code = line.substr(0, line.find("//"));
      code.erase(code.find_last_not_of(' ') + 1);
      if (code.empty() || code.back() != ';' || std::regex_match(line, none)) continue;
      const std::string declared = code.substr(0, std::min(code.find('='), code.find('{')));
      const bool callable = declared.find("std::function<") != std::string::npos;
      if (declared.find('(') != std::string::npos && !callable) continue;
      // One declaration may have several members: count commas outside template arguments.
      int depth = 0;
      for (const char c : code) {
        depth += c == '<' || c == '{' || c == '(' ? 1 : c == '>' || c == '}' || c == ')' ? -1 : 0;
        if (c == ',' && depth == 0) ++members;
      }
      ++members;
    }
    out.push_back({members, name[1]});
  }
  return out;
}

template <typename Measure>
std::vector<Size> sizes(const Measure& measure) {
  std::vector<Size> out;
  for (const char* part : {"protocol", "modules", "shaders", "server", "client"}) {
    for (const auto& entry : fs::recursive_directory_iterator(fs::path(MIRAGE_SOURCE_DIR) / part)) {
      const std::string kind = entry.path().extension().string();
      if (kind != ".h" && kind != ".cpp") continue;
      for (Size& size : measure(lines_of(entry.path()))) {
        size.what += "  " + fs::relative(entry.path(), MIRAGE_SOURCE_DIR).string();
        out.push_back(std::move(size));
      }
    }
  }
  std::sort(out.begin(), out.end());
  return out;
}

void print(const char* what, const std::vector<Size>& all) {
  std::printf("%zu %s; the largest:\n", all.size(), what);
  for (std::size_t i = 0; i < std::min<std::size_t>(all.size(), 12); ++i) {
    std::printf("%5d  %s\n", all[i].size, all[i].what.c_str());
  }
}

// CONTRIBUTING asks for about 60 lines, except for tables.
TEST(Sizes, NoFunctionGrowsBeyondTheLongest) {
  static const std::regex table(
      "^.*(?:need_rules|parse_options|options_of_all_programs|finishes|SessionStats::json)  .*");
  std::vector<Size> all = sizes(functions_in);
  print("functions by lines", all);
  ASSERT_GT(all.size(), 1000u);
  all.erase(std::remove_if(all.begin(), all.end(),
                           [](const Size& s) { return std::regex_match(s.what, table); }),
            all.end());
  EXPECT_LE(all.front().size, 60);
}

// The aim is about 15.
TEST(Sizes, NoTypeGrowsBeyondTheLargest) {
  const std::vector<Size> all = sizes(types_in);
  print("types by data members", all);
  ASSERT_GT(all.size(), 300u);
  EXPECT_LE(all.front().size, 41);
}

TEST(Sizes, AreCounted) {
  const std::vector<Size> functions = functions_in(
      {"int a(int b) {", "  return b;", "}", "", "void C::d(int e,", "         int f) {",
       "  if (e) {", "  }", "}", "", "template <typename T>", "int g(int h = 0) {", "}"});
  ASSERT_EQ(functions.size(), 3u);
  EXPECT_EQ(functions[0].size, 3);
  EXPECT_EQ(functions[1].size, 5);
  EXPECT_EQ(functions[2].size, 2);
  const std::vector<Size> types =
      types_in({"struct A {", "  int a = 0, b = 1;  ///< two", "  std::map<int, int> c;",
                "  int d() const;", "  struct B {", "    int e;", "  };",
                "  std::function<void(int)> f{};", "  glm::vec4 g, h,", "      i;", "};"});
  ASSERT_EQ(types.size(), 1u);
  EXPECT_EQ(types[0].size, 7);
}

}  // namespace
}  // namespace mirage::test
