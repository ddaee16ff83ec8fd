// Addresses of the page, as a server tells them when it is ready.
#include <gtest/gtest.h>

#include "server/net/listen_address.h"

namespace mirage {
namespace {

std::vector<std::string> urls(const std::string& listen, bool tls = false) {
  return page_urls(parse_listen(listen).take(), tls, 8080);
}

using Urls = std::vector<std::string>;

TEST(ServerPageUrls, AreWhatABrowserOpens) {
  EXPECT_EQ(urls("127.0.0.1:0"), Urls{"http://127.0.0.1:8080/"});
  EXPECT_EQ(urls("[::1]:0", true), Urls{"https://[::1]:8080/"});
  EXPECT_EQ(urls("box.example:0"), Urls{"http://box.example:8080/"});
  EXPECT_EQ(urls("unix:/tmp/socket"), Urls{});
}

TEST(ServerPageUrls, OfAllInterfacesAreThoseOfTheMachine) {
  for (const char* listen : {"0.0.0.0:0", "[::]:0"}) {
    const Urls found = urls(listen);
    ASSERT_FALSE(found.empty());
    EXPECT_LE(found.size(), 8u);
    for (const std::string& url : found) {
      EXPECT_EQ(url.find("0.0.0.0"), std::string::npos) << "nobody can open it";
      EXPECT_EQ(url.find("[::]"), std::string::npos);
      EXPECT_EQ(url.find("fe80:"), std::string::npos) << "needs the name of an interface";
    }
  }
}

}  // namespace
}  // namespace mirage
