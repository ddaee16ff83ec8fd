// Downloads as visitors ask for them, and the commands that make them.
#include "server/download/download_request.h"

#include <gtest/gtest.h>

#include "server/net/download_http.h"

namespace mirage::test {
namespace {

const DownloadScene kScene = {"/models/my knot.glb", "", "studio", "auto", true};

std::variant<DownloadRequest, std::string> read(const std::string& query) {
  return read_download_request(query_values(query));
}

bool has(const std::vector<std::string>& line, const std::vector<std::string>& words) {
  return std::search(line.begin(), line.end(), words.begin(), words.end()) != line.end();
}

TEST(DownloadRequest, ABakeIsOfOneObjectOrOfAll) {
  const auto one = read("kind=bake&object=3&target=godot4&grid=8&size=1024");
  ASSERT_TRUE(std::holds_alternative<DownloadRequest>(one)) << std::get<std::string>(one);
  const auto& request = std::get<DownloadRequest>(one);
  EXPECT_EQ(download_program(request), "mirage-bake");
  const auto line = download_arguments(request, kScene, "/tmp/x");
  EXPECT_EQ(line[0], kScene.scene);
  EXPECT_TRUE(has(line, {"--object", "3"}) && has(line, {"--target", "godot4"}));
  EXPECT_TRUE(has(line, {"--grid", "8"}) && has(line, {"--size", "1024"}));
  EXPECT_EQ(download_name(request, kScene), "my-knot-3-godot4.zip");
  const auto all = download_arguments(std::get<DownloadRequest>(read("kind=bake")), kScene, "/x");
  EXPECT_TRUE(has(all, {"--whole"}));
}

TEST(DownloadRequest, AFolderIsOfAPlaceOrFromAllAround) {
  const auto here =
      std::get<DownloadRequest>(read("kind=folder&eye=1,2,3&look=1,2,0&reach=2&mb=5"));
  EXPECT_EQ(download_program(here), "mirage-freeze");
  DownloadScene closed = kScene;
  closed.geometry = false;
  const auto line = download_arguments(here, closed, "/x");
  EXPECT_TRUE(has(line, {"--box", "-1,2,1,3,2,5"}));
  EXPECT_TRUE(has(line, {"--home", "1,2,3,1,2,0"}));
  EXPECT_TRUE(has(line, {"--mb", "5"}) && has(line, {"--no-geometry"}));
  const auto around =
      download_arguments(std::get<DownloadRequest>(read("kind=folder")), kScene, "/x");
  EXPECT_FALSE(has(around, {"--box"}) || has(around, {"--no-geometry"}));
}

TEST(DownloadRequest, NamesWhatIsWrong) {
  const std::pair<const char*, const char*> wrong[] = {
      {"", "kind"},
      {"kind=x", "kind"},
      {"kind=bake&object=-1", "object"},
      {"kind=bake&object=1.5", "object"},
      {"kind=bake&object=99999999999", "object"},
      {"kind=bake&target=", "target"},
      {"kind=bake&target=--whole", "target"},
      {"kind=bake&target=a;b", "target"},
      {"kind=bake&grid=1", "grid"},
      {"kind=bake&grid=1000", "grid"},
      {"kind=bake&size=63", "size"},
      {"kind=bake&size=nan", "size"},
      {"kind=bake&mb=5", "mb"},
      {"kind=folder&object=1", "object"},
      {"kind=folder&eye=1,2,3", "eye and look"},
      {"kind=folder&eye=1,2,3&look=1,2,3", "look is where"},
      {"kind=folder&eye=1,2&look=1,2,3", "eye"},
      {"kind=folder&eye=nan,2,3&look=0,0,0", "eye"},
      {"kind=folder&eye=1e300,2,3&look=0,0,0", "eye"},
      {"kind=folder&eye=1,2,3,4&look=0,0,0", "eye"},
      {"kind=folder&reach=-1", "reach"},
      {"kind=folder&reach=inf", "reach"},
      {"kind=folder&mb=0", "mb"},
      {"kind=folder&mb=1000", "mb"},
  };
  for (const auto& [query, word] : wrong) {
    const auto got = read(query);
    ASSERT_TRUE(std::holds_alternative<std::string>(got)) << query;
    EXPECT_NE(std::get<std::string>(got).find(word), std::string::npos)
        << query << ": " << std::get<std::string>(got);
  }
}

TEST(DownloadRequest, AFilesNameIsPlain) {
  const DownloadRequest folder = FolderDownload{};
  const auto name = [&](const std::string& scene) {
    return download_name(folder, {scene, "", "studio", "auto", true});
  };
  EXPECT_EQ(name("builtin:forest?trees=3"), "forest-trees-3-folder.zip");
  EXPECT_EQ(name("/a/b\"\r\nX: y.glb"), "b---X--y-folder.zip");
  EXPECT_EQ(name(""), "scene-folder.zip");
}

}  // namespace
}  // namespace mirage::test
