// The structure of the code: which file includes which. Rooms are folders; the table says which
// rooms a room may include. Prints it with the number of includes, and how deep and wide they go.
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <functional>
#include <map>
#include <regex>
#include <set>
#include <string>
#include <vector>

namespace mirage::test {
namespace {

namespace fs = std::filesystem;
using Names = std::set<std::string>;
using Graph = std::map<std::string, Names>;

// Intended arrows: a room may include those above it.
const Graph kMayInclude = {
    {"protocol/base", {}},
    {"protocol/model", {"protocol/base"}},
    {"protocol/impostor", {"protocol/base", "protocol/model"}},
    {"protocol/codec", {"protocol/base", "protocol/model", "protocol/impostor"}},
    {"protocol/wire", {"protocol/base", "protocol/model", "protocol/impostor", "protocol/codec"}},
    {"protocol/quality", {}},
    {"protocol/output", {"protocol/base"}},
    {"protocol/process", {"protocol/base"}},
    {"modules", {"protocol/base"}},
    {"shaders/gl", {"protocol/base", "protocol/model", "protocol/impostor"}},
    {"client/frame", {"protocol/base", "protocol/model", "protocol/impostor"}},
    {"client/link", {"protocol/base", "protocol/impostor", "protocol/wire"}},
    {"client/folder", {"protocol/base", "protocol/codec", "protocol/wire"}},
    {"client/scene",
     {"protocol/base", "protocol/model", "protocol/impostor", "protocol/codec", "protocol/wire"}},
    {"client/hold",
     {"protocol/base", "protocol/model", "protocol/impostor", "protocol/codec", "protocol/wire",
      "client/frame", "client/scene"}},
    {"client/price",
     {"protocol/model", "protocol/impostor", "client/frame", "client/scene", "client/hold"}},
    {"client/plan",
     {"protocol/base", "protocol/model", "protocol/impostor", "protocol/wire", "client/frame",
      "client/scene", "client/hold", "client/price"}},
    {"client/ask",
     {"protocol/base", "protocol/codec", "client/link", "client/scene", "client/hold",
      "client/price", "client/plan"}},
    {"client/draw",
     {"protocol/base", "protocol/model", "protocol/impostor", "protocol/codec", "shaders/gl",
      "client/frame", "client/scene", "client/hold"}},
    {"client/session",
     {"protocol/base", "protocol/model", "protocol/impostor", "protocol/codec", "protocol/wire",
      "client/frame", "client/link", "client/scene", "client/hold", "client/price", "client/plan",
      "client/ask"}},
    {"client/screen",
     {"protocol/base", "protocol/impostor", "client/frame", "client/scene", "client/plan",
      "client/price", "client/draw", "client/session"}},
    {"client/door",
     {"protocol/base", "shaders/gl", "client/frame", "client/scene", "client/price", "client/draw",
      "client/session", "client/screen"}},
    {"client/web",
     {"protocol/base", "protocol/model", "protocol/quality", "protocol/impostor", "protocol/wire",
      "shaders/gl", "client/frame", "client/link", "client/folder", "client/scene", "client/hold",
      "client/price", "client/plan", "client/draw", "client/session", "client/screen",
      "client/door"}},
    {"client/native", {"protocol/base", "protocol/model", "protocol/wire", "client/link"}},
    {"client/library",
     {"protocol/base", "protocol/model", "protocol/impostor", "shaders/gl", "client/frame",
      "client/link", "client/scene", "client/price", "client/plan", "client/draw", "client/session",
      "client/screen", "client/door", "client/native"}},
    {"client/host",
     {"protocol/base", "protocol/process", "protocol/model", "protocol/impostor", "client/frame",
      "client/link", "client/folder", "client/scene", "client/price", "client/plan",
      "client/session", "client/door", "client/native"}},
    {"client/load",
     {"protocol/base", "protocol/codec", "protocol/wire", "client/frame", "client/scene",
      "client/plan", "client/native"}},
    {"client/view",
     {"modules", "protocol/base", "protocol/model", "protocol/quality", "protocol/impostor",
      "shaders/gl", "client/frame", "client/link", "client/scene", "client/hold", "client/price",
      "client/plan", "client/draw", "client/session", "client/screen", "client/door",
      "client/native", "client/host"}},
    {"client/freeze",
     {"protocol/base", "protocol/impostor", "protocol/model", "protocol/codec", "protocol/wire",
      "protocol/output", "client/frame", "client/link", "client/folder", "client/scene",
      "client/hold", "client/price", "client/session", "client/native", "client/host"}},
    {"client/report",
     {"modules",           "protocol/base",  "protocol/process", "protocol/quality",
      "protocol/impostor", "protocol/codec", "protocol/wire",    "shaders/gl",
      "client/frame",      "client/link",    "client/scene",     "client/hold",
      "client/price",      "client/plan",    "client/draw",      "client/session",
      "client/screen",     "client/door",    "client/native",    "client/host"}},
    {"server/base", {"protocol/base"}},
    {"server/source", {"protocol/base", "protocol/impostor", "protocol/codec", "server/base"}},
    {"server/scene", {"protocol/base", "protocol/model", "protocol/impostor"}},
    {"server/scene/builtin", {"protocol/base", "protocol/model", "server/base", "server/scene"}},
    {"server/scene/environment",
     {"modules", "protocol/base", "protocol/impostor", "server/base", "server/scene"}},
    {"server/scene/gltf",
     {"modules", "protocol/base", "protocol/model", "protocol/impostor", "protocol/codec",
      "server/base", "server/scene"}},
    {"server/lod",
     {"protocol/base", "protocol/model", "protocol/impostor", "server/base", "server/scene"}},
    {"server/prepare",
     {"protocol/base", "protocol/model", "protocol/impostor", "protocol/codec", "server/base",
      "server/scene", "server/scene/builtin", "server/scene/environment", "server/scene/gltf",
      "server/lod"}},
    {"server/ground", {"protocol/base", "protocol/model", "server/prepare"}},
    {"server/tile",
     {"modules", "protocol/base", "protocol/model", "protocol/impostor", "protocol/codec",
      "protocol/wire", "server/base", "server/source"}},
    {"server/render",
     {"protocol/base", "protocol/model", "protocol/impostor", "protocol/codec", "shaders/gl",
      "server/prepare", "server/tile"}},
    {"server/stage",
     {"protocol/base", "protocol/impostor", "protocol/codec", "protocol/wire", "shaders/gl",
      "server/base", "server/prepare", "server/ground", "server/tile", "server/render"}},
    {"server/session",
     {"protocol/base", "protocol/model", "protocol/impostor", "protocol/codec", "protocol/wire",
      "server/base", "server/scene", "server/prepare", "server/tile", "server/stage"}},
    {"server/download", {"protocol/base", "protocol/model", "protocol/output", "protocol/process"}},
    {"server/net",
     {"protocol/base", "protocol/wire", "server/base", "server/tile", "server/session",
      "server/download"}},
    {"server/prove",
     {"protocol/base", "protocol/model", "protocol/impostor", "protocol/codec", "shaders/gl",
      "server/scene", "server/prepare", "server/tile", "server/render"}},
    {"server/bake",
     {"modules", "protocol/base", "protocol/model", "protocol/quality", "protocol/output",
      "protocol/impostor", "shaders/gl", "server/base", "server/scene", "server/prepare",
      "server/render"}},
    {"server",
     {"protocol/base", "protocol/model", "protocol/impostor", "protocol/wire", "shaders/gl",
      "server/base", "server/source", "server/scene/builtin", "server/scene/environment",
      "server/prepare", "server/stage", "server/session", "server/net", "server/prove"}},
};

std::string room_of(const std::string& file) { return fs::path(file).parent_path().string(); }

/// Returns our own files by name, each with our own headers that it includes.
const Graph& includes() {
  static const Graph all = [] {
    Graph out;
    const fs::path root = MIRAGE_SOURCE_DIR;
    const std::regex own("^#include \"([^\"]+)\"");
    for (const char* part : {"protocol", "modules", "shaders", "server", "client"}) {
      for (const auto& entry : fs::recursive_directory_iterator(root / part)) {
        const std::string kind = entry.path().extension().string();
        if (kind != ".h" && kind != ".cpp") continue;
        Names& headers = out[fs::relative(entry.path(), root).string()];
        std::ifstream text(entry.path());
        std::smatch match;
        for (std::string line; std::getline(text, line);) {
          if (std::regex_search(line, match, own) && fs::exists(root / match[1].str())) {
            headers.insert(match[1]);
          }
        }
      }
    }
    return out;
  }();
  return all;
}

/// Returns what can be reached from `from`; `from` itself only if it is in a circle.
Names reached(const Graph& graph, const std::string& from) {
  Names seen;
  std::vector<std::string> next = {from};
  while (!next.empty()) {
    const auto at = graph.find(next.back());
    next.pop_back();
    if (at == graph.end()) continue;
    for (const std::string& to : at->second) {
      if (seen.insert(to).second) next.push_back(to);
    }
  }
  return seen;
}

/// Returns the largest sets whose members all reach each other.
std::set<Names> circles(const Graph& graph) {
  std::set<Names> out;
  for (const auto& [node, to] : graph) {
    const Names from_here = reached(graph, node);
    if (from_here.count(node) == 0) continue;
    Names circle;
    for (const std::string& other : from_here) {
      if (reached(graph, other).count(node) != 0) circle.insert(other);
    }
    out.insert(circle);
  }
  return out;
}

int depth_of(const std::string& file, std::map<std::string, int>& known) {
  const auto at = known.find(file);
  if (at != known.end()) return at->second;
  known[file] = 1;  // a circle ends here; another test finds it
  int deepest = 0;
  const auto headers = includes().find(file);
  if (headers != includes().end()) {
    for (const std::string& h : headers->second) deepest = std::max(deepest, depth_of(h, known));
  }
  return known[file] = deepest + 1;
}

TEST(Includes, EveryArrowBetweenRoomsIsInTheTable) {
  std::map<std::pair<std::string, std::string>, int> arrows;
  for (const auto& [file, headers] : includes()) {
    for (const std::string& header : headers) {
      const std::string from = room_of(file), to = room_of(header);
      if (from == to) continue;
      ++arrows[{from, to}];
      const auto row = kMayInclude.find(from);
      const bool may = row != kMayInclude.end() && row->second.count(to) != 0;
      EXPECT_TRUE(may) << file << " includes " << header;
    }
  }
  for (const auto& [arrow, count] : arrows) {
    std::printf("%-26s -> %-26s %4d\n", arrow.first.c_str(), arrow.second.c_str(), count);
  }
  for (const auto& [from, row] : kMayInclude) {
    for (const std::string& to : row) {
      EXPECT_EQ(arrows.count({from, to}), 1u) << from << " -> " << to << " is no longer needed";
    }
  }
}

TEST(Includes, NoRoomsIncludeEachOther) { EXPECT_EQ(circles(kMayInclude), std::set<Names>{}); }

TEST(Includes, NoFilesIncludeEachOther) { EXPECT_EQ(circles(includes()), std::set<Names>{}); }

TEST(Includes, AreNeitherDeeperNorWiderThanTheyWere) {
  std::vector<std::size_t> seen;
  std::map<std::string, int> known;
  int deepest = 0;
  for (const auto& [file, headers] : includes()) {
    deepest = std::max(deepest, depth_of(file, known));
    if (fs::path(file).extension() == ".cpp") seen.push_back(reached(includes(), file).size());
  }
  std::sort(seen.begin(), seen.end());
  const std::size_t p95 = seen[seen.size() * 95 / 100];
  std::printf("%zu files; own headers a .cpp sees: median %zu, p95 %zu, most %zu; %d deep\n",
              includes().size(), seen[seen.size() / 2], p95, seen.back(), deepest);
  // The aims are 30 and 10.
  EXPECT_LE(p95, 55u);
  EXPECT_LE(deepest, 11);
}

TEST(Includes, CirclesAreFound) {
  EXPECT_EQ(circles({{"a", {"b"}}, {"b", {"c"}}, {"c", {"b", "d"}}, {"d", {}}}),
            (std::set<Names>{{"b", "c"}}));
  EXPECT_TRUE(circles({{"a", {"b", "c"}}, {"b", {"c"}}}).empty());
}

}  // namespace
}  // namespace mirage::test
