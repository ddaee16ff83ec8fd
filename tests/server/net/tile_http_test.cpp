// Tiles by HTTP: what a request is for, who may send it, and how it is answered.
#include "server/net/tile_http.h"

#include <gtest/gtest.h>

namespace mirage::test {
namespace {

constexpr std::uint64_t kRevision = 0x123456789abcdef0;
constexpr std::int64_t kNow = 1'800'000'000;
const std::string kFolder = "/v1/tile/123456789abcdef0/";
const std::string kKey = "0123456789abcdef0123456789abcdef";

unsigned int status_of(const HttpRequest& request, const Access& access = {}) {
  const auto read = read_tile_request(request, kRevision, access, kNow);
  const auto* refused = std::get_if<HttpAnswer>(&read);
  return refused ? refused->status : 200;
}

TEST(TileAddress, OneSpellingEach) {
  TileAddress address;
  address.instance = 4'000'000'000;
  address.cell = {5, 10, 11};
  address.distance = {2, -3};
  address.size_class = 8;
  address.channels = 3;
  EXPECT_EQ(address.text(), "4000000000.5.10.11.2.-3.8.3.zstd");
  address.phase = 256;
  address.codec = TileCodec::kWebp;
  EXPECT_EQ(address.text(), "4000000000.5.10.11.2.-3.8.3.256.webp");
  const TileAddress back = parse_tile_address(address.text()).value();
  EXPECT_EQ(back.text(), address.text());
  EXPECT_EQ(back.distance.index, -3);
  for (const char* wrong :
       {"", ".", "1.2.3", "4000000000.5.10.11.2.-3.8.3", "4000000000.5.10.11.2.-3.8.3.gif",
        "04.5.10.11.2.3.8.3.zstd", "1.5.10.11.2.-0.8.3.zstd", "1.5.10.11.2.3.8.3.0.zstd",
        "1.5.10.11.2.3.8.3.00.zstd", "1.256.10.11.2.3.8.3.zstd", "5000000000.5.1.1.2.3.8.3.zstd",
        "1.5.70000.11.2.3.8.3.zstd", "1.5.10.11.2.3.8.3.zstd.", "1.5. 10.11.2.3.8.3.zstd",
        "1.5.+10.11.2.3.8.3.zstd", "1.5.10.11.2.3.8.3.1.1.zstd", "-1.5.10.11.2.3.8.3.zstd"}) {
    EXPECT_FALSE(parse_tile_address(wrong)) << wrong;
  }
  EXPECT_FALSE(parse_tile_address(std::string(100'000, '1')));
}

TEST(TileHttp, OfThisRevisionOnly) {
  EXPECT_EQ(status_of({kFolder + "1.5.10.11.2.3.8.3.zstd", "", ""}), 200u);
  EXPECT_EQ(status_of({"/v1/tile/123456789abcdef1/1.5.10.11.2.3.8.3.zstd", "", ""}), 404u);
  EXPECT_EQ(status_of({"/v1/tile/1.5.10.11.2.3.8.3.zstd", "", ""}), 404u);
  EXPECT_EQ(status_of({kFolder, "", ""}), 404u);
  EXPECT_EQ(status_of({kFolder + "nonsense", "", ""}), 404u);
  EXPECT_EQ(status_of({kFolder + "../1.5.10.11.2.3.8.3.zstd", "", ""}), 404u);
}

TEST(TileHttp, WithATokenOrASignature) {
  const Access access = Access::parse("secret\nkey=" + kKey + "\n").take();
  const std::string path = kFolder + "1.5.10.11.2.3.8.3.zstd";
  const auto query = [](std::int64_t until, const std::string& signature) {
    return "until=" + std::to_string(until) + "&signature=" + signature;
  };
  const std::string right = path_signature(kKey, kFolder, kNow + 10);
  EXPECT_EQ(status_of({path, "", ""}, access), 401u);
  EXPECT_EQ(status_of({path, "", "Bearer secret"}, access), 200u);
  EXPECT_EQ(status_of({path, "", "Bearer secrets"}, access), 401u);
  EXPECT_EQ(status_of({path, query(kNow + 10, right), ""}, access), 200u);
  EXPECT_EQ(status_of({path, query(kNow + 11, right), ""}, access), 401u) << "not for longer";
  EXPECT_EQ(status_of({path, query(kNow, path_signature(kKey, kFolder, kNow)), ""}, access), 401u)
      << "over";
  EXPECT_EQ(status_of({path, query(kNow + 10, ""), ""}, access), 401u);
  EXPECT_EQ(status_of({path, "signature=" + right, ""}, access), 401u);
  const std::string other = "/v1/tile/0000000000000001/1.5.10.11.2.3.8.3.zstd";
  EXPECT_EQ(status_of({other, query(kNow + 10, right), ""}, access), 401u)
      << "it tells not even that this is no revision";
}

TEST(TileHttp, AnswersMayBeKept) {
  GotTile tile{1, {1, 2, 3}, 0xab};
  const HttpAnswer whole = tile_answer(tile, TileCodec::kZstd, true, "");
  EXPECT_EQ(whole.status, 200u);
  EXPECT_EQ(whole.body, "\1\2\3");
  EXPECT_NE(whole.headers.find("public, max-age=31536000, immutable"), std::string::npos);
  EXPECT_NE(whole.headers.find("ETag: \"00000000000000ab-zstd\""), std::string::npos);
  const HttpAnswer known = tile_answer(tile, TileCodec::kZstd, true, "\"00000000000000ab-zstd\"");
  EXPECT_EQ(known.status, 304u);
  EXPECT_EQ(known.body, "");
  EXPECT_EQ(tile_answer(tile, TileCodec::kWebp, true, "\"00000000000000ab-zstd\"").status, 200u);
  EXPECT_NE(tile_answer(tile, TileCodec::kZstd, false, "").headers.find("private"),
            std::string::npos);
  tile.reason = wire::RefusalReason::Busy;
  EXPECT_EQ(tile_answer(tile, TileCodec::kZstd, true, "").status, 503u);
  EXPECT_NE(tile_answer(tile, TileCodec::kZstd, true, "").headers.find("Retry-After"),
            std::string::npos);
  tile.reason = wire::RefusalReason::BadKey;
  EXPECT_EQ(tile_answer(tile, TileCodec::kZstd, true, "").status, 404u);
}

}  // namespace
}  // namespace mirage::test
