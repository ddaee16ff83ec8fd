// Impostors by HTTP, the poster in the page, and what other sites are told, of the shipped server.
#include <gtest/gtest.h>

#include <csignal>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>

#include "tests/support/colored_box.h"
#include "tests/support/http_get.h"
#include "tests/support/metrics.h"

namespace mirage::test {
namespace {

namespace fs = std::filesystem;

/// Returns a folder for --web, with the places that a page has for the poster.
std::string page_with_places() {
  const fs::path folder = scratch_folder() + "/page";
  fs::create_directories(folder);
  std::ofstream(folder / "index.html") << "<head><!--head--></head><main><!--poster--></main>";
  return folder.string();
}

bool has_poster(const Answer& page) { return page.body.find("id=\"poster\"") != std::string::npos; }

/// Returns the page once it has its poster.
Answer page_with_poster(const Server& server) {
  Answer page;
  soon([&] { return has_poster(page = get(server, "/")); });
  return page;
}

TEST(Impostors, ArePicturesWithDepthMadeOnce) {
  const Server server("builtin:knot", {"--metrics"});
  ASSERT_TRUE(server.ready()) << server.log();
  const std::string path = "/v1/impostor?size=160x90&samples=1";
  const Answer first = get(server, path);
  ASSERT_EQ(first.status, 200) << first.body;
  EXPECT_NE(first.head.find("image/webp"), std::string::npos);
  EXPECT_NE(first.head.find("Access-Control-Allow-Origin: *"), std::string::npos);
  EXPECT_NE(first.body.find("MIRI"), std::string::npos);
  const double made = metrics(server)["references_rendered_total"];
  EXPECT_EQ(get(server, "/v1/impostor?samples=1&size=160x90").body, first.body);
  EXPECT_EQ(metrics(server)["references_rendered_total"], made);
  EXPECT_NE(get(server, "/v1/picture?size=160x90&samples=1").body, first.body) << "has no depth";
  const Answer kept = get(server, path, "If-None-Match: " + tag_of(first) + "\r\n");
  EXPECT_EQ(kept.status, 304);
  EXPECT_TRUE(kept.body.empty());
  for (const char* wrong : {"?size=0x0", "?size=16384x16384", "?eye=nan,0,0&look=0,0,0",
                            "?format=png", "?fov=nan", "?size=4096x4096&samples=4"}) {
    EXPECT_EQ(get(server, std::string("/v1/impostor") + wrong).status, 400) << wrong;
  }
}

TEST(Impostors, ComeToWhoMayLook) {
  const std::string tokens = scratch_folder() + "/tokens";
  std::ofstream(tokens) << "a-token-that-is-long-enough\n";
  const Server closed("builtin:knot", {"--token-file", tokens, "--web", page_with_places()});
  ASSERT_TRUE(closed.ready()) << closed.log();
  EXPECT_EQ(get(closed, "/v1/impostor?size=16x16").status, 401);
  EXPECT_EQ(get(closed, "/v1/impostor?size=16x16",
                "Authorization: Bearer a-token-that-is-long-enough\r\n")
                .status,
            200);
  EXPECT_EQ(get(closed, "/v1/oembed?url=http://x/").status, 403);
  const Server bare("builtin:knot", {"--no-reference", "--web", page_with_places()});
  ASSERT_TRUE(bare.ready()) << bare.log();
  EXPECT_EQ(get(bare, "/v1/impostor").status, 403);
  for (const Server* const one : {&closed, &bare}) {
    EXPECT_EQ(get(*one, "/").status, 200);
    std::this_thread::sleep_for(std::chrono::seconds(2));  // a poster would be there
    const Answer page = get(*one, "/");
    EXPECT_EQ(page.body, "<head><!--head--></head><main><!--poster--></main>");
  }
}

TEST(Posters, AreMadeOnceAtFirstDemand) {
  const Server server("builtin:knot", {"--metrics", "--web", page_with_places()});
  ASSERT_TRUE(server.ready()) << server.log();
  const Answer first = get(server, "/");
  EXPECT_EQ(first.status, 200);
  EXPECT_FALSE(has_poster(first)) << "nobody waits for it";
  EXPECT_TRUE(has_poster(page_with_poster(server)));
  const double made = metrics(server)["references_rendered_total"];
  for (int i = 0; i < 5; ++i) EXPECT_TRUE(has_poster(get(server, "/")));
  EXPECT_EQ(metrics(server)["references_rendered_total"], made);
  EXPECT_EQ(metrics(server)["pictures_sent_total"], 1) << "asked for once";
}

// With a picture as good as /v1/impostor, the page would have more.
TEST(Posters, TakeFewBytesOfADetailedScene) {
  const Server server("builtin:forest?trees=60", {"--web", page_with_places()});
  ASSERT_TRUE(server.ready()) << server.log();
  ASSERT_TRUE(has_poster(page_with_poster(server)));
  const Answer zipped = get(server, "/", "Accept-Encoding: gzip, br\r\n");
  EXPECT_NE(zipped.head.find("gzip"), std::string::npos);
  EXPECT_NE(zipped.head.find("no-cache"), std::string::npos);
  EXPECT_LT(zipped.body.size(), 40'000u);
  EXPECT_GT(get(server, "/v1/impostor?size=800x400").body.size(), 40'000u);
}

// A poster of this forest takes a second. The wide one has waited for the scene's levels.
TEST(Posters, GiveWayToWhatSomebodyWaitsFor) {
  const Server server("builtin:forest", {"--web", page_with_places()});
  ASSERT_TRUE(server.ready()) << server.log();
  ASSERT_TRUE(has_poster(page_with_poster(server)));
  const auto on_phone = [&] { return has_poster(get(server, "/", "User-Agent: Mobile\r\n")); };
  EXPECT_FALSE(on_phone());
  std::this_thread::sleep_for(std::chrono::milliseconds(200));  // it is under way
  EXPECT_EQ(get(server, "/v1/picture?size=16x16&samples=1").status, 200);
  EXPECT_FALSE(on_phone());
  EXPECT_TRUE(soon(on_phone)) << "it begins again";
}

TEST(Posters, ShowTheSceneThatIsServed) {
  const fs::path file = fs::path(scratch_folder()) / "scene.glb";
  const auto write = [&](const Color& color) {
    std::ofstream(file.string() + ".next", std::ios::binary) << box(color);
    fs::rename(file.string() + ".next", file);
  };
  write(kRed);
  const Server server(file.string(), {"--web", page_with_places()});
  ASSERT_TRUE(server.ready()) << server.log();
  const std::string red = page_with_poster(server).body;
  write(kGreen);
  kill(server.pid(), SIGHUP);
  ASSERT_TRUE(soon([&] { return server.log().find("serves revision") != std::string::npos; }));
  EXPECT_NE(get(server, "/").body, red) << "at once";
  const Answer green = page_with_poster(server);
  EXPECT_TRUE(has_poster(green));
  EXPECT_NE(green.body, red);
}

TEST(Posters, NothingOfAHostBecomesMarkup) {
  const Server server("builtin:knot", {"--web", page_with_places()});
  ASSERT_TRUE(server.ready()) << server.log();
  EXPECT_NE(
      get(server, "/", "", "example.org").body.find("content=\"http://example.org/v1/picture"),
      std::string::npos);
  for (const char* host : {"x\" onload=\"alert(1)", "x'", "<script>alert(1)</script>", "x y"}) {
    const Answer page = get(server, "/", "", host);
    EXPECT_EQ(page.body.find("alert"), std::string::npos) << host;
    EXPECT_EQ(page.body.find("og:"), std::string::npos) << host;
    EXPECT_EQ(get(server, "/v1/oembed?url=http://x/", "", host).body.find("alert"),
              std::string::npos);
  }
  const Answer proxied =
      get(server, "/", "X-Forwarded-Host: front.example\r\nX-Forwarded-Proto: https\r\n");
  EXPECT_NE(proxied.body.find("https://front.example/v1/picture"), std::string::npos)
      << "a proxy on this machine is believed";
}

TEST(Posters, OembedShowsALinkOfThisServer) {
  const Server server("builtin:knot");
  ASSERT_TRUE(server.ready()) << server.log();
  const Answer answer =
      get(server,
          "/v1/oembed?maxwidth=320&url=http%3A%2F%2Fexample.org%2F%23eye%3D0%2C0%2C9"
          "%26look%3D0%2C0%2C0",
          "", "example.org");
  ASSERT_EQ(answer.status, 200) << answer.body;
  const auto json = nlohmann::json::parse(answer.body, nullptr, false);
  EXPECT_EQ(json["type"], "rich");
  const std::string thumbnail = json["thumbnail_url"];
  EXPECT_EQ(thumbnail,
            "http://example.org/v1/picture?size=320x180&format=jpeg&eye=0,0,9&look=0,0,0");
  EXPECT_EQ(get(server, thumbnail.substr(thumbnail.find("/v1/"))).status, 200);
  EXPECT_EQ(get(server, "/v1/oembed?url=http://evil.example/", "", "example.org").status, 404);
  EXPECT_EQ(get(server, "/v1/oembed", "", "example.org").status, 400);
}

}  // namespace
}  // namespace mirage::test
