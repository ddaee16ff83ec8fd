// Pictures by HTTP, of the shipped server: as true as its full render, kept, and limited.
#include <OpenImageIO/filesystem.h>
#include <OpenImageIO/imageio.h>
#include <gtest/gtest.h>

#include <chrono>
#include <cstdio>
#include <fstream>
#include <memory>
#include <thread>

#include "tests/support/http_get.h"
#include "tests/support/library_fixture.h"
#include "tests/support/metrics.h"

namespace mirage::test {
namespace {

/// Returns the pixels of an image file, RGB, rows from the top; empty: it is none.
Pixels decoded(const std::string& file, const std::string& name, int& width, int& height) {
  OIIO::Filesystem::IOMemReader memory(const_cast<char*>(file.data()), file.size());
  const auto in = OIIO::ImageInput::open(name, nullptr, &memory);
  if (!in) return {};
  width = in->spec().width;
  height = in->spec().height;
  Pixels out(static_cast<std::size_t>(width * height * in->spec().nchannels));
  if (!in->read_image(0, 0, 0, in->spec().nchannels, OIIO::TypeDesc::UINT8, out.data())) return {};
  return in->spec().nchannels == 3 ? out : Pixels{};
}

// The library's reference has 4 samples a side.
TEST_F(Library, APictureIsTheFullRender) {
  LibraryClient client(server_.url());
  const Canvas canvas;
  const mirage_view view = view_from(9);
  ASSERT_TRUE(client.rest(view, canvas.target()));
  ASSERT_EQ(mirage_reference_ask(client.get(), &view), MIRAGE_OK);
  mirage_image image = sized<mirage_image>();
  for (int i = 0; i < 2000 && !image.rgba; ++i) {
    ASSERT_EQ(mirage_update(client.get(), clock_us(), nullptr), MIRAGE_OK);
    mirage_reference_take(client.get(), &image);
    std::this_thread::sleep_for(std::chrono::milliseconds(5));
  }
  ASSERT_TRUE(image.rgba);
  const std::string size = std::to_string(kWidth) + "x" + std::to_string(kHeight);
  const std::string path = "/v1/picture?eye=0,0,9&look=0,0,0&samples=4&size=" + size;
  int width = 0, height = 0;
  const Answer png = get(server_, path + "&format=png");
  ASSERT_EQ(png.status, 200) << png.body;
  const Pixels seen = decoded(png.body, "a.png", width, height);
  ASSERT_EQ(seen.size(), std::size_t{3} * kWidth * kHeight);
  std::size_t differ = 0;
  for (std::size_t i = 0; i < seen.size(); ++i) {
    differ += seen[i] != image.rgba[i / 3 * 4 + i % 3] ? 1 : 0;
  }
  EXPECT_EQ(differ, 0u);
  for (const char* format : {"webp", "jpeg"}) {
    const Answer lossy = get(server_, path + "&format=" + format);
    ASSERT_EQ(lossy.status, 200);
    const std::string name = std::string("a.") + (format[0] == 'w' ? "webp" : "jpg");
    const Pixels near = decoded(lossy.body, name, width, height);
    ASSERT_EQ(near.size(), seen.size()) << format;
    double error = 0;
    for (std::size_t i = 0; i < seen.size(); ++i) error += std::abs(near[i] - seen[i]);
    EXPECT_LT(error / static_cast<double>(seen.size()), 4) << format;
    EXPECT_LT(lossy.body.size(), png.body.size()) << format;
  }
}

// With fewer samples than a comparison has, far geometry is simplified; nobody shall see it.
TEST(Pictures, WithFewSamplesAreNearlyTheFullRender) {
  const Server server("builtin:forest?trees=60");
  ASSERT_TRUE(server.ready()) << server.log();
  const auto pixels = [&](const std::string& samples) {
    int width = 0, height = 0;
    const Answer answer = get(server, "/v1/picture?size=160x90&format=png&samples=" + samples);
    return decoded(answer.body, "x.png", width, height);
  };
  const Pixels exact = pixels("4"), usual = pixels("3");
  ASSERT_EQ(exact.size(), std::size_t{3} * 160 * 90);
  ASSERT_EQ(usual.size(), exact.size());
  double error = 0;
  for (std::size_t i = 0; i < exact.size(); ++i) error += std::abs(usual[i] - exact[i]);
  EXPECT_GT(error, 0);
  EXPECT_LT(error / static_cast<double>(exact.size()), 4);
}

TEST(Pictures, AreMadeOnceAndKept) {
  const Server server("builtin:knot", {"--metrics"});
  ASSERT_TRUE(server.ready()) << server.log();
  const Answer first = get(server, "/v1/picture?size=64x48&samples=1");
  ASSERT_EQ(first.status, 200) << first.body;
  const double made = metrics(server)["references_rendered_total"];
  EXPECT_EQ(get(server, "/v1/picture?samples=1&size=64x48").body, first.body);
  EXPECT_EQ(metrics(server)["references_rendered_total"], made);
  EXPECT_EQ(metrics(server)["pictures_sent_total"], 2);
  const std::string same = tag_of(first);
  ASSERT_FALSE(same.empty()) << first.head;
  const Answer kept =
      get(server, "/v1/picture?size=64x48&samples=1", "If-None-Match: " + same + "\r\n");
  EXPECT_EQ(kept.status, 304);
  EXPECT_TRUE(kept.body.empty());
  EXPECT_NE(get(server, "/v1/picture?size=64x48&samples=1&light=200,10").body, first.body)
      << "another light";
  EXPECT_EQ(get(server, "/v1/picture?size=0x0").status, 400);
}

// Everybody gets the answer to the same request at once, made once.
TEST(Pictures, OneStrangerCannotFillTheServer) {
  const Server server("builtin:knot", {"--metrics"});
  ASSERT_TRUE(server.ready()) << server.log();
  std::vector<std::unique_ptr<RawPeer>> strangers;
  for (int i = 0; i < 200; ++i) {
    strangers.push_back(std::make_unique<RawPeer>(server.port()));
    const std::string eye = std::to_string(i) + ",0,9";
    ask(*strangers.back(), "/v1/picture?eye=" + eye + "&look=0,0,0&size=1024x1024&samples=4");
  }
  std::map<int, int> statuses;
  for (const auto& one : strangers) ++statuses[read_answer(*one).status];
  EXPECT_GT(statuses[200], 20);
  EXPECT_GT(statuses[429], 20) << "refused by name";
  EXPECT_EQ(statuses[200] + statuses[429], 200);
  EXPECT_EQ(get(server, "/v1/picture?size=16x16").status, 200) << "and serves on";
}

TEST(Pictures, NobodyWaitsForTheOnesThatAreGone) {
  const Server server("builtin:knot", {"--metrics"});
  ASSERT_TRUE(server.ready()) << server.log();
  for (int i = 0; i < 30; ++i) {
    RawPeer peer(server.port());
    ask(peer, "/v1/picture?eye=" + std::to_string(i) + ",1,9&look=0,0,0&size=2048x2048&samples=2");
  }
  EXPECT_EQ(get(server, "/v1/picture?size=16x16").status, 200);
  EXPECT_LT(metrics(server)["references_rendered_total"], 12);
}

TEST(Pictures, TokensAndSignaturesOpenTheWay) {
  const std::string tokens = scratch_folder() + "/tokens";
  std::ofstream(tokens) << "a-token-that-is-long-enough\n"
                        << "key=0123456789abcdef0123456789abcdef0123456789abcdef\n";
  const Server server("builtin:knot", {"--token-file", tokens});
  ASSERT_TRUE(server.ready()) << server.log();
  const std::string path = "/v1/picture?size=16x16";
  EXPECT_EQ(get(server, path).status, 401);
  EXPECT_EQ(get(server, path, "Authorization: Bearer a-token-that-is-long-enough\r\n").status, 200);
  const Finished printed =
      run({binary("mirage-token"), "--key-file", tokens, "--path", "/v1/picture", "--hours", "1"});
  ASSERT_EQ(printed.exit_code, 0) << printed.output;
  const std::string query = printed.output.substr(0, printed.output.find('\n'));
  EXPECT_EQ(get(server, path + "&" + query).status, 200) << query;
  EXPECT_EQ(get(server, path + "&" + query + "0").status, 401);
}

TEST(Pictures, NoReferenceMeansNoPictures) {
  const Server server("builtin:knot", {"--no-reference"});
  ASSERT_TRUE(server.ready()) << server.log();
  const Answer refused = get(server, "/v1/picture");
  EXPECT_EQ(refused.status, 403);
  EXPECT_NE(refused.body.find("--no-reference"), std::string::npos) << refused.body;
}

}  // namespace
}  // namespace mirage::test
