// oEmbed: which links are shown, how large, and what hostile ones get.
#include "server/net/oembed.h"

#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

namespace mirage::test {
namespace {

const std::string kHere = "https://example.org";

nlohmann::json shown(const std::string& query) {
  const HttpAnswer answer = oembed_answer(query, kHere);
  EXPECT_EQ(answer.status, 200u) << query << ": " << answer.body;
  return nlohmann::json::parse(answer.body, nullptr, false);
}

TEST(Oembed, AViewIsAFrameAndAThumbnail) {
  // The link's own `&` arrives decoded.
  const auto out = shown("url=" + kHere + "/#eye=1,2,3&look=0,0,0&maxwidth=320&format=json");
  EXPECT_EQ(out["version"], "1.0");
  EXPECT_EQ(out["type"], "rich");
  EXPECT_EQ(out["width"], 320);
  EXPECT_EQ(out["height"], 180);
  EXPECT_EQ(out["html"],
            "<iframe src=\"https://example.org/#eye=1,2,3&amp;look=0,0,0\" width=\"320\" "
            "height=\"180\" title=\"Mirage\" allowfullscreen style=\"border:0\"></iframe>");
  EXPECT_EQ(out["thumbnail_url"],
            kHere + "/v1/picture?size=320x180&format=jpeg&eye=1,2,3&look=0,0,0");
}

TEST(Oembed, ItFitsIntoWhatIsWanted) {
  EXPECT_EQ(shown("url=" + kHere + "/")["width"], 640);
  EXPECT_EQ(shown("url=" + kHere + "/&maxwidth=5000")["width"], 640);
  EXPECT_EQ(shown("url=" + kHere + "/&maxheight=90")["width"], 160);
  EXPECT_EQ(shown("url=" + kHere + "/&maxwidth=1&maxheight=1")["height"], 1);
}

TEST(Oembed, OtherLinksAndMarkupAreRefused) {
  for (const auto& [query, status] : {std::pair<std::string, unsigned>{"", 400},
                                      {"url=", 400},
                                      {"url=" + kHere + "/" + std::string(3000, 'a'), 400},
                                      {"url=" + kHere + "/&maxwidth=nan", 400},
                                      {"url=" + kHere + "/&maxheight=-1", 400},
                                      {"url=" + kHere + "/&maxwidth=99999999999999999999", 400},
                                      {"url=" + kHere + "/&format=xml", 501},
                                      {"url=https://example.org.evil/", 404},
                                      {"url=https://elsewhere.org/", 404},
                                      {"url=javascript:alert(1)", 404},
                                      {"url=" + kHere + "/\"onload=\"alert(1)", 404},
                                      {"url=" + kHere + "/'><script>", 404}}) {
    const HttpAnswer answer = oembed_answer(query, kHere);
    EXPECT_EQ(answer.status, status) << query << ": " << answer.body;
    EXPECT_EQ(answer.body.find("alert"), std::string::npos) << "nothing of the request comes back";
  }
}

TEST(Oembed, ItsAddressNamesThePage) {
  EXPECT_EQ(oembed_address("http://h:1"),
            "http://h:1/v1/oembed?format=json&url=http%3A%2F%2Fh%3A1%2F");
}

}  // namespace
}  // namespace mirage::test
