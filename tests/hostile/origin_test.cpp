// Origins: the pages that a browser may come from, and what an upgrade must name. A header that no
// browser sends is no Origin; other programs are let in.

#include <gtest/gtest.h>

#include "tests/hostile/web_socket.h"
#include "tests/support/process.h"

namespace mirage::test {
namespace {

struct OriginCase {
  std::string name;
  Upgrade request;
  bool open;
};

Upgrade from(const std::string& origin, const std::string& host = "mirage.example:9870") {
  Upgrade out;
  out.host = "Host: " + host + "\r\n";
  out.more = "Origin: " + origin + "\r\n";
  return out;
}
Upgrade with_protocol(const std::string& names) {
  Upgrade out;
  out.protocol = names.empty() ? "" : "Sec-WebSocket-Protocol: " + names + "\r\n";
  return out;
}
Upgrade with_more(const std::string& more) {
  Upgrade out;
  out.host = "Host: mirage.example:9870\r\n";
  out.more = more;
  return out;
}

std::vector<OriginCase> common_cases() {
  const std::string own = "http://mirage.example:9870";
  std::vector<OriginCase> out = {
      {"none", Upgrade{}, true},
      {"own", from(own), true},
      {"own in capitals", from("HTTP://Mirage.Example:9870"), true},
      {"own, the port that is meant", from("http://mirage.example", "mirage.example:80"), true},
      {"own, the port that is told", from("http://mirage.example:80", "mirage.example"), true},
      {"own by number", from("http://127.0.0.1:9870", "127.0.0.1:9870"), true},
      {"own by number, 6", from("http://[::1]:9870", "[::1]:9870"), true},
      {"empty, which no browser says", with_more("Origin: \r\n"), true},
      // The browser says which host it asks. So a page passes whose own name was made to mean this
      // machine; a token stops it.
      {"of a name made to mean us", from("http://evil.example:1", "evil.example:1"), true},
      {"another", from("http://evil.example"), false},
      {"another port", from("http://mirage.example:9871"), false},
      {"no port", from("http://mirage.example"), false},
      {"another scheme", from("https://mirage.example:9870"), false},
      {"no scheme", from("mirage.example:9870"), false},
      {"a file", from("file://"), false},
      {"null", from("null"), false},
      {"own and more", from(own + ".evil.example"), false},
      {"own and digits", from(own + "0"), false},
      {"own within", from("http://evil.example/" + own), false},
      {"own as a user", from(own + "@evil.example"), false},
      {"own with a path", from(own + "/x"), false},
      {"own with a slash", from(own + "/"), false},
      {"own twice", from(own + ", " + own), false},
      {"own, then another", from(own + " http://evil.example"), false},
      {"another, then own", with_more("Origin: http://evil.example\r\nOrigin: " + own + "\r\n"),
       false},
      {"own, then another header",
       with_more("Origin: " + own + "\r\nOrigin: http://evil.example\r\n"), false},
      {"name in small letters", with_more("origin: http://evil.example\r\n"), false},
      {"name in capitals", with_more("ORIGIN: http://evil.example\r\n"), false},
      {"no space", with_more("Origin:http://evil.example\r\n"), false},
      {"a tab", with_more("Origin:\thttp://evil.example\r\n"), false},
      {"subprotocol none", with_protocol(""), false},
      {"subprotocol another", with_protocol("chat"), false},
      {"subprotocol http", with_protocol("http"), false},
      {"subprotocol longer", with_protocol("mirage2"), false},
      {"subprotocol shorter", with_protocol("mirag"), false},
      {"subprotocol in capitals", with_protocol("MIRAGE"), false},
      {"subprotocol first of two", with_protocol("mirage, chat"), true},
      {"subprotocol second of two", with_protocol("chat, mirage"), true},
  };
  for (const std::size_t length : {255, 256, 257, 300, 511, 512, 513, 1000, 3000}) {
    out.push_back(
        {"of " + std::to_string(length), from("http://" + std::string(length - 7, 'e')), false});
    // A reader that cuts the value would see an allowed one.
    out.push_back(
        {"own, then " + std::to_string(length), from(own + std::string(length, ' ') + "x"), false});
  }
  return out;
}

void expect_origin_cases(const Server& server, const std::vector<OriginCase>& cases) {
  for (const OriginCase& c : cases) {
    const WebSocket peer(server.port(), {}, c.request);
    EXPECT_EQ(peer.open(), c.open) << c.name;
  }
}

TEST(Origin, IsTheServersOwnOrNone) {
  const Server server("builtin:knot?tubular=60&radial=12", {"--no-view"});
  ASSERT_TRUE(server.ready()) << server.log();
  expect_origin_cases(server, common_cases());
  expect_origin_cases(server, {{"not allowed", from("https://viewer.example"), false}});
}

TEST(Origin, IsAlsoTheOneThatIsAllowed) {
  const Server server("builtin:knot?tubular=60&radial=12",
                      {"--no-view", "--allow-origin", "https://viewer.example", "--allow-origin",
                       "https://second.example:8443"});
  ASSERT_TRUE(server.ready()) << server.log();
  expect_origin_cases(server, common_cases());
  expect_origin_cases(server,
                      {{"allowed", from("https://viewer.example"), true},
                       {"the second", from("https://second.example:8443"), true},
                       {"its name in http", from("http://viewer.example"), false},
                       {"allowed and more", from("https://viewer.example.evil.example"), false},
                       {"allowed, a port", from("https://viewer.example:443"), false}});
}

Upgrade forwarded(const std::string& headers, const std::string& origin) {
  Upgrade out;
  out.host = "Host: mirage\r\n";  // as a proxy writes it that tells where the server is
  out.more = "Origin: " + origin + "\r\n" + headers;
  return out;
}

TEST(Origin, IsWhatTheBrowserCalledIfAProxyOfThisMachineSaysSo) {
  const std::string page = "https://viewer.example";
  const std::string tells = "X-Forwarded-Host: viewer.example\r\nX-Forwarded-Proto: https\r\n";
  const Server server("builtin:knot?tubular=60&radial=12", {"--no-view"});
  ASSERT_TRUE(server.ready()) << server.log();
  expect_origin_cases(
      server,
      {{"told", forwarded(tells, page), true},
       {"told by the standard",
        forwarded("Forwarded: for=192.0.2.1;host=viewer.example;proto=https\r\n", page), true},
       {"not told", forwarded("", page), false},
       {"told of another", forwarded(tells, "https://evil.example"), false},
       {"told of http", forwarded("X-Forwarded-Host: viewer.example\r\n", page), false}});
  const Server careful("builtin:knot?tubular=60&radial=12", {"--no-view", "--trust-proxy", "none"});
  ASSERT_TRUE(careful.ready()) << careful.log();
  expect_origin_cases(careful, {{"told, and not believed", forwarded(tells, page), false}});
}

TEST(Origin, ARefusedPageIsToldAndLogged) {
  const Server server("builtin:knot?tubular=60&radial=12", {"--no-view"});
  ASSERT_TRUE(server.ready()) << server.log();
  const WebSocket peer(server.port(), {}, from("http://evil.example"));
  EXPECT_FALSE(peer.open());
  EXPECT_NE(peer.answer().find(" 403 "), std::string::npos) << peer.answer();
  const std::string log = server.log();
  EXPECT_NE(log.find("a page of http://evil.example may not connect"), std::string::npos) << log;
  EXPECT_NE(log.find("--allow-origin http://evil.example"), std::string::npos) << log;
}

}  // namespace
}  // namespace mirage::test
