// Handshake keys and WebSocket close packets, right and wrong.
#include "server/net/websocket_rules.h"

#include <gtest/gtest.h>

namespace mirage::test {
namespace {

TEST(WebSocketRules, AKeyIsSixteenBytesInBase64) {
  EXPECT_TRUE(is_upgrade_key("dGhlIHNhbXBsZSBub25jZQ=="));
  EXPECT_TRUE(is_upgrade_key("++++++++++//////////AA=="));
  EXPECT_FALSE(is_upgrade_key(""));
  EXPECT_FALSE(is_upgrade_key("AAAA"));
  EXPECT_FALSE(is_upgrade_key("dGhlIHNhbXBsZSBub25jZXg=")) << "17 bytes";
  EXPECT_FALSE(is_upgrade_key("dGhlIHNhbXBsZSBub25jZXh4")) << "18 bytes";
  EXPECT_FALSE(is_upgrade_key("dGhlIHNhbXBsZSBub25jZQ===")) << "25 signs";
  EXPECT_FALSE(is_upgrade_key("dGhlIHNhbXBsZSBub25j-_==")) << "of another alphabet";
}

TEST(WebSocketRules, ACloseHasNothingOrACodeThatMayBeSent) {
  const auto right = [](int code) {
    const std::uint8_t body[] = {static_cast<std::uint8_t>(code >> 8),
                                 static_cast<std::uint8_t>(code & 0xff), 'x'};
    return is_close_body(body, 2) && is_close_body(body, 3);
  };
  for (const int code : {1000, 1003, 1007, 1011, 1014, 3000, 4999})
    EXPECT_TRUE(right(code)) << code;
  for (const int code : {0, 999, 1004, 1005, 1006, 1015, 1016, 2999, 5000, 65535}) {
    EXPECT_FALSE(right(code)) << code;
  }
  const std::uint8_t one = 3;
  EXPECT_TRUE(is_close_body(&one, 0));
  EXPECT_FALSE(is_close_body(&one, 1));
}

}  // namespace
}  // namespace mirage::test
