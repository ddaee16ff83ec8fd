// Listening: the addresses that a server can listen on, and clients that connect there.

#include <gtest/gtest.h>
#include <sys/stat.h>

#include <csignal>
#include <fstream>

#include "tests/support/process.h"

namespace mirage::test {
namespace {

constexpr const char* kScene = "builtin:knot?tubular=60&radial=12";

void expect_served(const Server& server) {
  const Finished load = run({binary("mirage-load"), server.url(), "--clients", "1", "--duration",
                             "3", "--rate", "20", "--verify", "1"});
  EXPECT_EQ(load.exit_code, 0) << server.url() << ": " << load.output;
  const Finished view = run({binary("mirage-view"), server.url(), "--offscreen", "64x64",
                             "--frames", "10", "--path", "builtin:still"});
  EXPECT_EQ(view.exit_code, 0) << server.url() << ": " << view.output;
}

TEST(Listen, OnANameAndOnIpv6) {
  for (const auto& [listen, url] :
       {std::pair{"localhost:0", "ws://localhost:"}, std::pair{"[::1]:0", "ws://[::1]:"}}) {
    Server server(kScene, {"--listen", listen});
    ASSERT_TRUE(server.ready()) << server.log();
    EXPECT_EQ(server.url().rfind(url, 0), 0u) << server.url();
    expect_served(server);
    EXPECT_EQ(server.stop(SIGTERM), 0);
  }
}

TEST(Listen, OnAUnixSocketWhichALaterServerTakesOver) {
  const std::string path = scratch_folder() + "/socket";
  const std::vector<std::string> listen = {"--listen", "unix:" + path};
  {
    Server server(kScene, listen);
    ASSERT_TRUE(server.ready()) << server.log();
    EXPECT_EQ(server.url(), "unix:" + path);
    expect_served(server);
    const Server second(kScene, listen);
    EXPECT_FALSE(second.ready()) << "the first still serves";
    EXPECT_NE(second.log().find("error network-listen:"), std::string::npos) << second.log();
    expect_served(server);
    EXPECT_EQ(server.stop(SIGKILL), 128 + SIGKILL);
  }
  Server heir(kScene, listen);
  ASSERT_TRUE(heir.ready()) << heir.log();
  expect_served(heir);
}

TEST(Listen, AFileIsNotTakenForASocket) {
  const std::string path = scratch_folder() + "/file";
  std::ofstream(path) << "precious";
  const Server server(kScene, {"--listen", "unix:" + path});
  EXPECT_FALSE(server.ready());
  EXPECT_EQ(read_file(path), "precious");
}

TEST(Listen, WrongAddressesAreSaidByName) {
  const auto listen = [](const std::string& address) {
    return run({binary("mirage-server"), kScene, "--listen", address}, 20);
  };
  for (const char* wrong : {"nowhere", "::1:9870", "[::1]", "[::1:9870", ":9870", "host:99999",
                            "host:", "unix:", "http://x:1"}) {
    EXPECT_EQ(listen(wrong).exit_code, 2) << wrong;
  }
  EXPECT_EQ(listen("no.such.host.invalid:0").exit_code, 5);
  for (const char* wrong : {"ws://[::1", "ws://[]:1", "unix:", "ws://[::1]x", "ws://host:0"}) {
    EXPECT_EQ(run({binary("mirage-view"), wrong, "--offscreen", "64x64"}).exit_code, 2) << wrong;
  }
}

// A larger render than a server draws is refused at once; nobody waits for it.
TEST(Listen, AReferenceThatNoServerDrawsIsRefusedByName) {
  Server server(kScene);
  ASSERT_TRUE(server.ready()) << server.log();
  const Finished view = run({binary("mirage-view"), server.url(), "--offscreen", "16384x1",
                             "--frames", "10", "--reference", "5"});
  EXPECT_EQ(view.exit_code, 2) << view.output;
  EXPECT_NE(view.output.find("8192"), std::string::npos) << view.output;
  EXPECT_LT(view.seconds, 5);
  const Finished wide = run({binary("mirage-view"), server.url(), "--offscreen", "8192x1",
                             "--frames", "10", "--reference", "5", "--reference-samples", "2"},
                            120);
  EXPECT_EQ(wide.exit_code, 0) << wide.output;
}

}  // namespace
}  // namespace mirage::test
