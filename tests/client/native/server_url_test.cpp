// Addresses of servers, as people write them.
#include "client/native/server_url.h"

#include <gtest/gtest.h>

namespace mirage {
namespace {

TEST(ClientServerUrl, AQueryChoosesClipAndVariant) {
  const ServerUrl url =
      parse_url("https://host/scenes/fox/?clip=Run%20fast&x=1&variant=dark+blue#eye=1,2,3").take();
  EXPECT_EQ(url.host, "host");
  EXPECT_EQ(url.port, 443);
  EXPECT_EQ(url.path, "/scenes/fox/");
  EXPECT_EQ(url.choice, (SceneChoice{"Run fast", "dark blue"}));
  EXPECT_EQ(parse_url("ws://host:1?clip=a%2Fb%26c").take().choice.clip, "a/b&c");
  EXPECT_EQ(parse_url("ws://host:1?clip=a%2Fb%26c").take().port, 1);
}

TEST(ClientServerUrl, WhatIsNoChoiceIsNone) {
  for (const char* query : {"", "?", "?clip", "?clip=", "?Clip=a", "?clips=a", "#?clip=a"}) {
    EXPECT_EQ(parse_url(std::string("ws://host/") + query).take().choice, SceneChoice{}) << query;
  }
  EXPECT_EQ(parse_url("ws://host/?clip=100%").take().choice.clip, "100%");
  EXPECT_EQ(parse_url("ws://host/?clip=%zz").take().choice.clip, "%zz");
  EXPECT_EQ(parse_url("ws://host/?clip=" + std::string(257, 'x')).take().choice.clip, "");
}

}  // namespace
}  // namespace mirage
