#include "server/net/qr_code.h"

#include <gtest/gtest.h>

#include <sstream>
#include <vector>

namespace mirage {
namespace {

/// Returns the modules of a code, true: dark. Each line holds two rows.
std::vector<std::vector<bool>> modules(const std::string& code) {
  std::vector<std::vector<bool>> out;
  std::istringstream lines(code);
  for (std::string line; std::getline(lines, line);) {
    std::vector<bool> upper, lower;
    for (std::size_t at = 0; at < line.size();) {
      const bool space = line[at] == ' ';
      const std::string character = line.substr(at, space ? 1 : 3);
      upper.push_back(space || character == "▄");
      lower.push_back(space || character == "▀");
      at += character.size();
    }
    out.push_back(upper);
    out.push_back(lower);
  }
  return out;
}

TEST(QrCode, HasThreeEyesInALightBorder) {
  const std::string text = qr_code("http://192.168.1.20:9870/");
  if (text.empty()) GTEST_SKIP() << "this build has no libqrencode";
  const auto at = modules(text);
  constexpr std::size_t kEdge = 25, kBorder = 2;  // version 2 holds 32 bytes
  ASSERT_GE(at.size(), kEdge + 2 * kBorder);
  for (const auto& row : at) ASSERT_EQ(row.size(), kEdge + 2 * kBorder);
  for (std::size_t i = 0; i < kEdge + 2 * kBorder; ++i) {
    EXPECT_FALSE(at[0][i] || at[1][i] || at[i][0] || at[i][1]) << i;
  }
  for (const auto& [x, y] : {std::pair{0u, 0u}, {18u, 0u}, {0u, 18u}}) {
    for (std::size_t v = 0; v < 7; ++v) {
      for (std::size_t u = 0; u < 7; ++u) {
        const std::size_t ring = std::min({u, v, 6 - u, 6 - v});
        EXPECT_EQ(at[kBorder + y + v][kBorder + x + u], ring != 1) << u << " " << v;
      }
    }
  }
}

TEST(QrCode, AnotherAddressIsAnotherCode) {
  if (qr_code("a").empty()) GTEST_SKIP() << "this build has no libqrencode";
  EXPECT_NE(qr_code("http://192.168.1.20:9870/"), qr_code("http://192.168.1.21:9870/"));
  EXPECT_TRUE(qr_code(std::string(4000, 'x')).empty());
  EXPECT_TRUE(qr_code("").empty());
}

}  // namespace
}  // namespace mirage
