// Pictures by HTTP: what a request is for, who may send it, and how it is answered.
#include "server/net/picture_http.h"

#include <gtest/gtest.h>

namespace mirage::test {
namespace {

constexpr std::int64_t kPictureNow = 1'800'000'000;
constexpr std::uint64_t kPictureRevision = 0x123456789abcdef0;
const std::string kSigningKey = "0123456789abcdef0123456789abcdef";

HttpRequest of(const std::string& query, const std::string& authorization = "") {
  return {kPicturePath, query, authorization};
}

PictureRequest picture(const std::string& query) {
  const auto read = read_picture_request(of(query), {}, kPictureNow);
  EXPECT_TRUE(std::holds_alternative<PictureRequest>(read)) << query;
  return std::holds_alternative<PictureRequest>(read) ? std::get<PictureRequest>(read)
                                                      : PictureRequest{};
}

HttpAnswer refused(const HttpRequest& request, const Access& access = {}) {
  const auto read = read_picture_request(request, access, kPictureNow);
  EXPECT_TRUE(std::holds_alternative<HttpAnswer>(read)) << request.query;
  return std::holds_alternative<HttpAnswer>(read) ? std::get<HttpAnswer>(read) : HttpAnswer{};
}

TEST(PictureHttp, EveryValueIsRead) {
  const PictureRequest plain = picture("");
  EXPECT_FALSE(plain.posed);
  EXPECT_FALSE(plain.sun);
  EXPECT_EQ(plain.camera.width, 640u);
  EXPECT_EQ(plain.camera.height, 360u);
  const PictureRequest one =
      picture("eye=1,2,-3.5&look=1,2,-9&size=320x200&format=jpeg&samples=3&light=-90,30&fov=45");
  EXPECT_TRUE(one.posed);
  EXPECT_EQ(one.camera.pose.eye, glm::dvec3(1, 2, -3.5));
  EXPECT_NEAR(one.camera.forward().z, -1, 1e-6);
  EXPECT_EQ(one.camera.width, 320u);
  EXPECT_EQ(one.format, PictureFormat::kJpeg);
  EXPECT_EQ(one.samples, 3u);
  EXPECT_EQ(one.sun->azimuth, -90);
  EXPECT_NEAR(one.camera.fov_y, 0.7853981633974483, 1e-12);
}

TEST(PictureHttp, WhatIsNotUsableIsNamed) {
  for (const auto& [query, named] : {std::pair{"eye=1,2,3", "eye and look"},
                                     {"eye=1,2,3&look=1,2,3", "look"},
                                     {"eye=1,2&look=0,0,0", "eye"},
                                     {"eye=1,2,3,4&look=0,0,0", "eye"},
                                     {"eye=nan,0,0&look=0,0,0", "eye"},
                                     {"eye=inf,0,0&look=0,0,0", "eye"},
                                     {"eye=1e300,0,0&look=0,0,0", "eye"},
                                     {"look=0,0,0", "eye and look"},
                                     {"size=0x9", "size"},
                                     {"size=9", "size"},
                                     {"size=-9x9", "size"},
                                     {"size=9x16384", "size"},
                                     {"size=99999999999x9", "size"},
                                     {"size=9x9x9", "size"},
                                     {"size=", "size"},
                                     {"size=4096x4096&samples=4", "samples"},
                                     {"format=gif", "format"},
                                     {"samples=0", "samples"},
                                     {"samples=5", "samples"},
                                     {"samples=2.5", "samples"},
                                     {"light=1", "light"},
                                     {"light=0,91", "light"},
                                     {"fov=0", "fov"},
                                     {"fov=nan", "fov"},
                                     {"colour=red", "'colour'"},
                                     {"size", "size"},
                                     {"=", "''"}}) {
    const HttpAnswer answer = refused(of(query));
    EXPECT_EQ(answer.status, 400u) << query;
    EXPECT_NE(answer.body.find(named), std::string::npos) << query << ": " << answer.body;
  }
  EXPECT_LT(refused(of(std::string(100'000, 'a') + "=1")).body.size(), 200u);
}

TEST(PictureHttp, AnImpostorIsAPictureWithoutAFormat) {
  const auto read = [](const std::string& query) {
    return read_picture_request({kImpostorPath, query, ""}, {}, kPictureNow);
  };
  const auto impostor = read("size=64x48&eye=0,0,9&look=0,0,0");
  ASSERT_TRUE(std::holds_alternative<PictureRequest>(impostor));
  const PictureRequest& wanted = std::get<PictureRequest>(impostor);
  EXPECT_EQ(wanted.format, PictureFormat::kImpostor);
  EXPECT_NE(wanted.key(), picture("size=64x48&eye=0,0,9&look=0,0,0").key());
  for (const char* wrong : {"format=png", "format=impostor", "size=16384x1", "eye=nan,0,0"}) {
    ASSERT_TRUE(std::holds_alternative<HttpAnswer>(read(wrong))) << wrong;
    EXPECT_EQ(std::get<HttpAnswer>(read(wrong)).status, 400u) << wrong;
  }
  EXPECT_EQ(refused(of("format=impostor")).status, 400u) << "it has an address of its own";
}

TEST(PictureHttp, ASignatureIsForOneKind) {
  const Access access = Access::parse("key=" + kSigningKey + "\n").take();
  const std::string query = "until=" + std::to_string(kPictureNow + 60) + "&signature=" +
                            path_signature(kSigningKey, kImpostorPath, kPictureNow + 60);
  const auto read = [&](const char* path) {
    return read_picture_request({path, query, ""}, access, kPictureNow);
  };
  EXPECT_TRUE(std::holds_alternative<PictureRequest>(read(kImpostorPath)));
  ASSERT_TRUE(std::holds_alternative<HttpAnswer>(read(kPicturePath)));
  EXPECT_EQ(std::get<HttpAnswer>(read(kPicturePath)).status, 401u);
}

TEST(PictureHttp, EqualPicturesHaveEqualTags) {
  const auto tag = [](const std::string& query) {
    return picture_tag(picture(query), kPictureRevision);
  };
  EXPECT_EQ(tag(""), tag("size=640x360&format=webp&samples=2&fov=60"));
  EXPECT_EQ(tag("eye=1,0,0&look=0,0,0&size=9x9"), tag("size=9x9&look=0,0,0&eye=1.0,0,0"));
  for (const char* other : {"size=641x360", "format=png", "samples=1", "fov=61", "light=0,45",
                            "eye=1,0,0&look=0,0,0", "eye=1.0000000001,0,0&look=0,0,0"}) {
    EXPECT_NE(tag(""), tag(other)) << other;
  }
  EXPECT_NE(tag("eye=1,0,0&look=0,0,0"), tag("eye=1.0000000001,0,0&look=0,0,0"));
  EXPECT_NE(tag(""), picture_tag(picture(""), kPictureRevision + 1));
}

TEST(PictureHttp, ATokenOrASignatureIsNeeded) {
  const Access access =
      Access::parse("a-token-that-is-long-enough\nkey=" + kSigningKey + "\n").take();
  EXPECT_EQ(refused(of(""), access).status, 401u);
  EXPECT_EQ(refused(of("", "Bearer wrong"), access).status, 401u);
  const auto good = read_picture_request(of("size=9x9", "Bearer a-token-that-is-long-enough"),
                                         access, kPictureNow);
  EXPECT_TRUE(std::holds_alternative<PictureRequest>(good));
  const std::string until = std::to_string(kPictureNow + 60);
  const std::string signature = path_signature(kSigningKey, kPicturePath, kPictureNow + 60);
  const std::string query = "size=9x9&until=" + until + "&signature=" + signature;
  EXPECT_TRUE(
      std::holds_alternative<PictureRequest>(read_picture_request(of(query), access, kPictureNow)));
  EXPECT_TRUE(std::holds_alternative<HttpAnswer>(
      read_picture_request(of(query), access, kPictureNow + 61)));
}

TEST(PictureHttp, AnswersSayHowLongTheyLast) {
  GotPicture got;
  got.file = std::make_shared<const Bytes>(Bytes{1, 2, 3});
  const HttpAnswer open = picture_answer(got, PictureFormat::kPng, "\"t\"", true);
  EXPECT_EQ(open.status, 200u);
  EXPECT_EQ(open.type, "image/png");
  EXPECT_EQ(open.body.size(), 3u);
  EXPECT_NE(open.headers.find("ETag: \"t\""), std::string::npos);
  EXPECT_NE(open.headers.find("public"), std::string::npos);
  const HttpAnswer shut = picture_answer(got, PictureFormat::kPng, "\"t\"", false);
  EXPECT_NE(shut.headers.find("private"), std::string::npos);
  EXPECT_EQ(shut.headers.find("Access-Control"), std::string::npos);
  for (const auto& [reason, status] : {std::pair{wire::RefusalReason::Busy, 503u},
                                       {wire::RefusalReason::NoReference, 403u},
                                       {wire::RefusalReason::TooLarge, 500u}}) {
    EXPECT_EQ(picture_answer({1, nullptr, reason}, PictureFormat::kPng, "", true).status, status);
  }
}

}  // namespace
}  // namespace mirage::test
