// Front page: what the server puts into index.html.
#include "server/net/front_page.h"

#include <gtest/gtest.h>
#include <zlib.h>

namespace mirage::test {
namespace {

const std::string kPage = "<head><!--head--></head><main><!--poster--></main>";

std::string unzipped(const std::string& bytes, std::size_t most) {
  z_stream stream{};
  std::string out(most, '\0');
  if (inflateInit2(&stream, MAX_WBITS + 16) != Z_OK) return "";
  stream.next_in = reinterpret_cast<Bytef*>(const_cast<char*>(bytes.data()));
  stream.avail_in = static_cast<uInt>(bytes.size());
  stream.next_out = reinterpret_cast<Bytef*>(out.data());
  stream.avail_out = static_cast<uInt>(out.size());
  const bool whole = inflate(&stream, Z_FINISH) == Z_STREAM_END;
  out.resize(whole ? stream.total_out : 0);
  inflateEnd(&stream);
  return out;
}

TEST(FrontPage, ThePosterIsInThePage) {
  const auto poster = std::make_shared<const Bytes>(Bytes{'R', 'I', 'F', 'F', 0xff});
  const std::string page = front_page(kPage, "", PosterShape::kWide, poster);
  EXPECT_NE(page.find("src=\"data:image/webp;base64,UklGRv8=\""), std::string::npos) << page;
  EXPECT_NE(page.find("<head></head>"), std::string::npos) << "nothing is told without an address";
  EXPECT_EQ(front_page(kPage, "", PosterShape::kWide, nullptr), "<head></head><main></main>");
}

TEST(FrontPage, OtherSitesAreToldWholeAddresses) {
  const std::string page = front_page(kPage, "https://example.org", PosterShape::kWide, nullptr);
  for (const char* told :
       {"property=\"og:title\"", "name=\"twitter:card\"",
        "content=\"https://example.org/v1/picture?size=1200x630&amp;format=jpeg\"",
        "href=\"https://example.org/v1/"
        "oembed?format=json&amp;url=https%3A%2F%2Fexample.org%2F\""}) {
    EXPECT_NE(page.find(told), std::string::npos) << told << " in " << page;
  }
}

TEST(FrontPage, APageWithoutPlacesStaysAsItIs) {
  const auto poster = std::make_shared<const Bytes>(Bytes{1});
  EXPECT_EQ(front_page("<p>", "https://example.org", PosterShape::kWide, poster), "<p>");
}

TEST(FrontPage, ZippedIsTheSameText) {
  std::string text = kPage;
  for (int i = 0; i < 12; ++i) text += text;
  EXPECT_EQ(unzipped(gzipped(text), text.size()), text);
  EXPECT_LT(gzipped(text).size(), text.size() / 20);
}

TEST(FrontPage, APosterIsSmallAndWaitsForEverybodyElse) {
  for (const PosterShape shape : {PosterShape::kWide, PosterShape::kTall}) {
    const PictureRequest poster = poster_request(shape);
    EXPECT_TRUE(poster.idle);
    EXPECT_FALSE(poster.posed);
    EXPECT_GT(poster.most_bytes, 10'000u);
    EXPECT_LT(poster.most_bytes, 40'000u);
  }
}

TEST(FrontPage, PhonesGetATallOne) {
  EXPECT_EQ(poster_shape("Mozilla/5.0 (Linux; Android 10; K) Chrome/120.0 Mobile Safari/537.36"),
            PosterShape::kTall);
  EXPECT_EQ(poster_shape("Mozilla/5.0 (X11; Linux x86_64; rv:120.0) Firefox/120.0"),
            PosterShape::kWide);
  EXPECT_EQ(poster_shape(""), PosterShape::kWide);
  const auto poster = std::make_shared<const Bytes>(Bytes{1});
  EXPECT_NE(front_page(kPage, "", PosterShape::kTall, poster).find("width=\"400\" height=\"800\""),
            std::string::npos);
}

}  // namespace
}  // namespace mirage::test
