// Handshakes: which requests become a WebSocket, and which do not (RFC 6455, section 4).

#include <gtest/gtest.h>

#include <cstdio>

#include "tests/hostile/beside.h"
#include "tests/hostile/web_socket.h"
#include "tests/support/process.h"

namespace mirage::test {
namespace {

constexpr const char* kReadsOn =
    "libwebsockets finds no end of the headers; closed after 10 s, as half a handshake is";
constexpr const char* kAnyCase = "libwebsockets reads methods in any case and does not tell us";

struct Case {
  const char* name;
  Upgrade request;
  const char* answer;    ///< its status; "": closed without one; "waits": for more
  const char* why = "";  ///< set where the standard says something else
};

Upgrade changed(std::string Upgrade::*part, const std::string& to) {
  Upgrade out;
  out.*part = to;
  return out;
}
Upgrade key(const std::string& value) {
  return changed(&Upgrade::key, "Sec-WebSocket-Key: " + value + "\r\n");
}
Upgrade version(const std::string& value) {
  return changed(&Upgrade::version, "Sec-WebSocket-Version: " + value + "\r\n");
}
Upgrade more(const std::string& text) { return changed(&Upgrade::more, text); }

std::vector<Case> handshakes() {
  const auto line = [](const std::string& text) { return changed(&Upgrade::line, text); };
  return {
      {"as it should be", {}, "101"},
      {"a path", line("GET /x HTTP/1.1\r\n"), "101"},
      {"a query", line("GET /?a=b HTTP/1.1\r\n"), "101"},
      {"HTTP/1.0", line("GET / HTTP/1.0\r\n"), ""},
      {"HTTP/0.9", line("GET /\r\n"), ""},
      {"HTTP/2.0", line("GET / HTTP/2.0\r\n"), ""},
      {"POST", line("POST / HTTP/1.1\r\n"), ""},
      {"HEAD", line("HEAD / HTTP/1.1\r\n"), ""},
      {"PUT", line("PUT / HTTP/1.1\r\n"), ""},
      {"OPTIONS", line("OPTIONS / HTTP/1.1\r\n"), ""},
      {"CONNECT", line("CONNECT / HTTP/1.1\r\n"), "waits", kReadsOn},
      {"no method of HTTP", line("BREW / HTTP/1.1\r\n"), "403"},
      {"get", line("get / HTTP/1.1\r\n"), "101", kAnyCase},
      {"a path of 10 KB", line("GET /" + std::string(10'000, 'x') + " HTTP/1.1\r\n"), ""},
      {"no Host", changed(&Upgrade::host, ""), ""},
      {"no Upgrade", changed(&Upgrade::upgrade, ""), "404"},
      {"Upgrade to another", changed(&Upgrade::upgrade, "Upgrade: h2c\r\n"), ""},
      {"Upgrade in capitals", changed(&Upgrade::upgrade, "UPGRADE: WebSocket\r\n"), "101"},
      {"no Connection", changed(&Upgrade::connection, ""), ""},
      {"Connection: close", changed(&Upgrade::connection, "Connection: close\r\n"), ""},
      {"Connection of two", changed(&Upgrade::connection, "Connection: keep-alive, Upgrade\r\n"),
       "101"},
      {"no version", changed(&Upgrade::version, ""), ""},
      {"version 0", version("0"), ""},
      {"version 8", version("8"), ""},
      {"version 12", version("12"), ""},
      {"version 14", version("14"), ""},
      {"version 013", version("013"), ""},
      {"version 13.0", version("13.0"), ""},
      {"version 13, 8", version("13, 8"), ""},
      {"version of letters", version("x"), ""},
      {"version empty", version(""), ""},
      {"no key", changed(&Upgrade::key, ""), ""},
      {"key empty", key(""), ""},
      {"key of 4", key("AAAA"), ""},
      {"key of 23", key("dGhlIHNhbXBsZSBub25jZQ="), ""},
      {"key of 25", key("dGhlIHNhbXBsZSBub25jZQ==="), ""},
      {"key of 17 bytes", key("dGhlIHNhbXBsZSBub25jZXg="), ""},
      {"key of 18 bytes", key("dGhlIHNhbXBsZSBub25jZXh4"), ""},
      {"key of no base64", key("????????????????????????"), ""},
      {"key of 200", key(std::string(200, 'A')), ""},
      {"two keys", more("Sec-WebSocket-Key: dGhlIHNhbXBsZSBub25jZQ==\r\n"), ""},
      {"an extension", more("Sec-WebSocket-Extensions: permessage-deflate\r\n"), "101"},
      {"an unknown header", more("X-Mirage: 1\r\n"), "101"},
      {"a header of 2 KB", more("X-Mirage: " + std::string(2'000, 'x') + "\r\n"), "101"},
      {"headers of 100 KB", more("X-Mirage: " + std::string(100'000, 'x') + "\r\n"), ""},
      {"a header with a NUL", more(std::string("X-A: a\0b\r\n", 10)), "waits", kReadsOn},
      {"a header without a colon", more("nonsense\r\n"), "waits", kReadsOn},
      {"a folded header", more("X-A: a\r\n b\r\n"), "waits", kReadsOn},
  };
}

std::string outcome(const WebSocket& peer) {
  const std::string& answer = peer.answer();
  if (answer.rfind("HTTP/1.", 0) == 0) return answer.substr(9, 3);
  return !answer.empty() ? "nonsense" : peer.ended() ? "" : "waits";
}

TEST(Handshake, BecomesAWebSocketOnlyAsTheStandardSays) {
  const Server server("builtin:knot?tubular=60&radial=12", {"--no-view", "--no-web"});
  ASSERT_TRUE(server.ready()) << server.log();
  int deviations = 0;
  const std::vector<Case> all = handshakes();
  std::vector<std::string> found(all.size());
  at_once(all.size(),
          [&](std::size_t i) { found[i] = outcome(WebSocket(server.port(), {}, all[i].request)); });
  for (std::size_t i = 0; i < all.size(); ++i) {
    EXPECT_EQ(found[i], all[i].answer) << all[i].name << " " << all[i].why;
    deviations += *all[i].why != '\0' ? 1 : 0;
  }
  std::printf("%zu handshakes, %d of them not as the standard says\n", all.size(), deviations);
}

TEST(Handshake, AnswersWithTheKeysDigest) {
  const Server server("builtin:knot?tubular=60&radial=12", {"--no-view"});
  ASSERT_TRUE(server.ready()) << server.log();
  const WebSocket peer(server.port());
  // The value for the sample nonce of RFC 6455, section 1.3.
  EXPECT_NE(peer.answer().find("s3pPLMBiTxaQ9kYGzzhZRbK+xOo="), std::string::npos);
  EXPECT_EQ(peer.answer().find("Extensions"), std::string::npos) << "none are spoken";
}

// A handshake may come in any pieces, together with packets.
TEST(Handshake, ComesInAnyPieces) {
  const Server server("builtin:knot?tubular=60&radial=12", {"--no-view"});
  ASSERT_TRUE(server.ready()) << server.log();
  const std::string request = Upgrade{}.bytes();
  for (std::size_t at = 1; at < request.size(); at += 17) {
    RawPeer peer(server.port());
    peer.say(request.substr(0, at));
    EXPECT_EQ(peer.hear_within(2), "");
    peer.say(request.substr(at));
    EXPECT_NE(peer.hear_within(2000).find("101"), std::string::npos) << at;
  }
  RawPeer peer(server.port());
  peer.say(request + ClientFrame{9, "at once"}.bytes());
  std::string heard;
  while (heard.find("at once") == std::string::npos) {
    const std::string part = peer.hear_within(2000);
    if (part.empty()) break;
    heard += part;
  }
  EXPECT_NE(heard.find("at once"), std::string::npos) << "a pong";
}

}  // namespace
}  // namespace mirage::test
