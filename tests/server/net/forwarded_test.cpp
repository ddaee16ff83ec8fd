// Forwarded: what was called and by whom, as trusted proxies tell.
#include "server/net/forwarded.h"

#include <gtest/gtest.h>

namespace mirage::test {
namespace {

ForwardingHeaders behind(const std::string& host) {
  ForwardingHeaders out;
  out.host = host;
  return out;
}

TEST(Forwarded, AStrangerIsNotBelieved) {
  ForwardingHeaders headers = behind("box:9870");
  headers.for_ = "192.0.2.9";
  headers.proto = "https";
  headers.forwarded_host = "evil.example";
  headers.forwarded = "for=192.0.2.9;host=evil.example;proto=https";
  const Called called = called_by("198.51.100.7", false, headers, TrustedProxies());
  EXPECT_EQ(called.host, "box:9870");
  EXPECT_FALSE(called.tls);
  EXPECT_EQ(called.address, "198.51.100.7");
}

TEST(Forwarded, AProxyOfThisMachineTellsWhatWasCalled) {
  ForwardingHeaders headers = behind("mirage");
  headers.for_ = "203.0.113.4, 192.0.2.9";
  headers.proto = "https";
  headers.forwarded_host = "viewer.example:8443";
  for (const char* peer : {"127.0.0.1", "::1", "::ffff:127.0.0.1", "unix"}) {
    const Called called = called_by(peer, false, headers, TrustedProxies());
    EXPECT_EQ(called.host, "viewer.example:8443");
    EXPECT_TRUE(called.tls);
    EXPECT_EQ(called.address, "192.0.2.9") << "what is before the last may be invented";
  }
  const Called bare = called_by("127.0.0.1", true, behind("box"), TrustedProxies());
  EXPECT_EQ(bare.host, "box");
  EXPECT_TRUE(bare.tls);
  EXPECT_EQ(bare.address, "127.0.0.1");
}

TEST(Forwarded, TheStandardHeaderWins) {
  ForwardingHeaders headers = behind("mirage");
  headers.proto = "http";
  headers.forwarded_host = "other.example";
  headers.forwarded =
      "for=\"[2001:db8::7]:4711\"; Proto=HTTPS ;host=\"viewer.example\", for=10.1.2.3:80";
  TrustedProxies proxies;
  ASSERT_TRUE(proxies.add("10.0.0.0/8"));
  const Called called = called_by("127.0.0.1", false, headers, proxies);
  EXPECT_EQ(called.host, "viewer.example");
  EXPECT_TRUE(called.tls);
  EXPECT_EQ(called.address, "2001:db8::7") << "10.1.2.3 is a proxy, too";
}

TEST(Forwarded, WhatIsNoAddressEndsTheChain) {
  ForwardingHeaders headers = behind("mirage");
  headers.for_ = "192.0.2.1, unknown";
  EXPECT_EQ(called_by("127.0.0.1", false, headers, TrustedProxies()).address, "127.0.0.1");
  headers.for_ = ",,;=\"";
  headers.forwarded = "for;host=;proto";
  const Called called = called_by("127.0.0.1", false, headers, TrustedProxies());
  EXPECT_EQ(called.address, "127.0.0.1");
  EXPECT_EQ(called.host, "mirage");
}

TEST(Forwarded, NetworksAreReadAndCompared) {
  TrustedProxies proxies;
  for (const char* right : {"10.0.0.0/8", "192.0.2.7", "2001:db8::/32", "0.0.0.0/0", "::/0"}) {
    TrustedProxies one;
    EXPECT_TRUE(one.add(right)) << right;
  }
  for (const char* wrong : {"", "10.0.0.0/33", "10.0.0.0/", "ten", "10.0.0.0/-1", "::/129", "/8"}) {
    EXPECT_FALSE(proxies.add(wrong)) << wrong;
  }
  ASSERT_TRUE(proxies.add("10.128.0.0/9"));
  EXPECT_TRUE(proxies.trusts("10.200.1.1"));
  EXPECT_TRUE(proxies.trusts("::ffff:10.200.1.1"));
  EXPECT_FALSE(proxies.trusts("10.1.1.1"));
  EXPECT_FALSE(proxies.trusts("name"));
  ASSERT_TRUE(proxies.add("none"));
  for (const char* own : {"127.0.0.1", "::1", "unix", "10.200.1.1"}) {
    EXPECT_FALSE(proxies.trusts(own)) << own;
  }
}

}  // namespace
}  // namespace mirage::test
