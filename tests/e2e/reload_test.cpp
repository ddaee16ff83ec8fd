// SIGHUP: another scene file and another certificate while the server runs.
#include <arpa/inet.h>
#include <gtest/gtest.h>
#include <openssl/ssl.h>
#include <openssl/x509.h>
#include <unistd.h>

#include <chrono>
#include <csignal>
#include <filesystem>
#include <fstream>
#include <thread>

#include "tests/support/colored_box.h"
#include "tests/support/process.h"

namespace mirage::test {
namespace {

namespace fs = std::filesystem;

/// Replaces a file at once, as files should be replaced.
void replace(const fs::path& path, const std::string& bytes) {
  const fs::path next = path.string() + ".next";
  std::ofstream(next, std::ios::binary) << bytes;
  fs::rename(next, path);
}

bool says(const Server& server, const std::string& text) {
  return soon([&] { return server.log().find(text) != std::string::npos; });
}

TEST(Reload, AnotherSceneTakesThePlaceOfTheFirstWithoutABlackFrame) {
  const fs::path folder = scratch_folder();
  const fs::path file = folder / "scene.glb";
  replace(file, box(kRed));
  const Server server(file.string(), {});
  ASSERT_TRUE(server.ready()) << server.log();
  Finished viewer;
  std::thread watching([&] {
    viewer = run({binary("mirage-view"), server.url(), "--offscreen", "160x90", "--path",
                  "builtin:still", "--fps", "20", "--frames", "200", "--out",
                  (folder / "frames").string()});
  });
  ASSERT_TRUE(soon([&] { return fs::exists(folder / "frames" / "frame_00030.png"); }));
  kill(server.pid(), SIGHUP);
  std::this_thread::sleep_for(std::chrono::milliseconds(500));  // nothing may be logged
  replace(file, box(kGreen));
  EXPECT_TRUE(says(server, "is another file than the one that is served: SIGHUP loads it"));
  EXPECT_EQ(server.log().find("anew"), std::string::npos) << "the file was the same";
  kill(server.pid(), SIGHUP);
  EXPECT_TRUE(says(server, "serves revision"));
  watching.join();
  EXPECT_EQ(viewer.exit_code, 0) << viewer.output;
  const std::string frames = seen_in(folder / "frames");
  const std::string shown = frames.substr(std::min(frames.find('r'), frames.size()));
  EXPECT_EQ(shown.find_first_not_of("rg"), std::string::npos) << frames;
  EXPECT_NE(shown.find("rg"), std::string::npos) << frames;
  EXPECT_EQ(shown.find("gr"), std::string::npos) << frames;
}

TEST(Reload, ASceneThatIsBrokenTakesNobodysPlace) {
  const fs::path file = fs::path(scratch_folder()) / "scene.glb";
  replace(file, box(kRed));
  const Server server(file.string(), {});
  ASSERT_TRUE(server.ready()) << server.log();
  replace(file, "glTF, or so it says");
  kill(server.pid(), SIGHUP);
  EXPECT_TRUE(says(server, "the scene stays as it is")) << server.log();
  const std::vector<std::string> look = {
      binary("mirage-view"), server.url(), "--offscreen", "160x90", "--frames", "5"};
  EXPECT_EQ(run(look).exit_code, 0);
  // The corrected file is loaded.
  replace(file, box(kGreen));
  kill(server.pid(), SIGHUP);
  EXPECT_TRUE(says(server, "serves revision")) << server.log();
  EXPECT_EQ(run(look).exit_code, 0);
}

/// A TLS connection that accepts any certificate.
class TlsPeer {
 public:
  explicit TlsPeer(int port) : socket_(socket(AF_INET, SOCK_STREAM, 0)) {
    sockaddr_in to{};
    to.sin_family = AF_INET;
    to.sin_port = htons(static_cast<std::uint16_t>(port));
    to.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    SSL_set_fd(ssl_.get(), socket_);
    met_ = connect(socket_, reinterpret_cast<sockaddr*>(&to), sizeof(to)) == 0 &&
           SSL_connect(ssl_.get()) == 1;
  }
  ~TlsPeer() { close(socket_); }
  TlsPeer(const TlsPeer&) = delete;
  TlsPeer& operator=(const TlsPeer&) = delete;

  /// Returns the common name in the server's certificate.
  std::string name() const {
    if (!met_) return "no handshake";
    const std::unique_ptr<X509, decltype(&X509_free)> certificate(
        SSL_get1_peer_certificate(ssl_.get()), X509_free);
    char text[64] = {};
    X509_NAME_get_text_by_NID(X509_get_subject_name(certificate.get()), NID_commonName, text,
                              sizeof(text));
    return text;
  }
  bool healthy() {
    const std::string ask = "GET /healthz HTTP/1.1\r\nHost: x\r\n\r\n";
    if (SSL_write(ssl_.get(), ask.data(), static_cast<int>(ask.size())) <= 0) return false;
    std::string heard;
    char part[512];
    while (heard.find("ok\n") == std::string::npos) {
      const int n = SSL_read(ssl_.get(), part, sizeof(part));
      if (n <= 0) return false;
      heard.append(part, static_cast<std::size_t>(n));
    }
    return true;
  }

 private:
  std::unique_ptr<SSL_CTX, decltype(&SSL_CTX_free)> context_{SSL_CTX_new(TLS_client_method()),
                                                             SSL_CTX_free};
  std::unique_ptr<SSL, decltype(&SSL_free)> ssl_{SSL_new(context_.get()), SSL_free};
  int socket_;
  bool met_ = false;
};

bool make_certificate(const fs::path& folder, const std::string& name) {
  return run({"/usr/bin/openssl", "req", "-x509", "-newkey", "ec", "-pkeyopt",
              "ec_paramgen_curve:P-256", "-nodes", "-days", "2", "-subj", "/CN=" + name, "-keyout",
              (folder / "key.pem").string(), "-out", (folder / "cert.pem").string()})
             .exit_code == 0;
}

TEST(Reload, AnotherCertificateIsShownToWhoComesAndDropsNobody) {
  const fs::path folder = scratch_folder();
  if (!make_certificate(folder, "first")) GTEST_SKIP() << "openssl is not installed";
  const Server server(
      "builtin:knot?tubular=16&radial=8",
      {"--tls-cert", (folder / "cert.pem").string(), "--tls-key", (folder / "key.pem").string()});
  ASSERT_TRUE(server.ready()) << server.log();
  TlsPeer early(server.port());
  EXPECT_EQ(early.name(), "first");
  ASSERT_TRUE(make_certificate(folder, "second"));
  EXPECT_EQ(TlsPeer(server.port()).name(), "first") << "not before the signal";
  kill(server.pid(), SIGHUP);
  EXPECT_TRUE(soon([&] { return TlsPeer(server.port()).name() == "second"; })) << server.log();
  EXPECT_TRUE(early.healthy()) << "who was there goes on";
  // A key that belongs to another certificate changes nothing.
  fs::rename(folder / "cert.pem", folder / "cert2.pem");
  ASSERT_TRUE(make_certificate(folder, "third"));
  fs::rename(folder / "cert2.pem", folder / "cert.pem");
  kill(server.pid(), SIGHUP);
  EXPECT_TRUE(says(server, "the certificate stays as it is")) << server.log();
  EXPECT_EQ(TlsPeer(server.port()).name(), "second");
  EXPECT_TRUE(early.healthy());
}

// Nobody knows from "read failed" that the server speaks TLS, or that its certificate is the cause.
TEST(Tls, AViewerSaysWhatIsWrongAndTrustsAFile) {
  const fs::path folder = scratch_folder();
  if (!make_certificate(folder, "localhost")) GTEST_SKIP() << "openssl is not installed";
  const std::string cert = (folder / "cert.pem").string();
  const Server secret("builtin:knot?tubular=16&radial=8",
                      {"--tls-cert", cert, "--tls-key", (folder / "key.pem").string()});
  const Server plain("builtin:knot?tubular=16&radial=8");
  ASSERT_TRUE(secret.ready() && plain.ready()) << secret.log();
  const auto answer = [&](const std::string& program, const std::string& scheme, const Server& to,
                          std::vector<std::string> more = {}) {
    std::vector<std::string> line = {binary(program),
                                     scheme + "://localhost:" + std::to_string(to.port())};
    line.insert(line.end(), more.begin(), more.end());
    return run(line);
  };
  // A viewer that waited for what no wait mends would take three minutes here.
  const std::vector<std::string> few = {"--offscreen",       "32x32", "--frames", "1",
                                        "--connect-timeout", "60"};
  const auto began = std::chrono::steady_clock::now();
  const std::vector<std::string> brief = {"--clients", "1", "--duration", "5"};
  for (const auto& [program, options] : {std::pair{"mirage-view", few}, {"mirage-load", brief}}) {
    const auto untrusted = answer(program, "wss", secret, options);
    EXPECT_NE(untrusted.exit_code, 0);
    EXPECT_NE(untrusted.output.find("is not trusted here"), std::string::npos) << untrusted.output;
    EXPECT_NE(untrusted.output.find("--tls-ca FILE"), std::string::npos) << untrusted.output;
    const auto tls = answer(program, "ws", secret, options);
    EXPECT_NE(
        tls.output.find("speaks TLS (hint: use wss://localhost:" + std::to_string(secret.port())),
        std::string::npos)
        << tls.output;
    const auto none = answer(program, "wss", plain, options);
    EXPECT_NE(none.output.find("speaks no TLS (hint: use ws://localhost:"), std::string::npos)
        << none.output;
    std::vector<std::string> trusting = options;
    trusting.insert(trusting.end(), {"--tls-ca", cert});
    const auto trusted = answer(program, "wss", secret, trusting);
    EXPECT_EQ(trusted.exit_code, 0) << trusted.output;
  }
  EXPECT_LT(std::chrono::steady_clock::now() - began, std::chrono::seconds(60));
}

}  // namespace
}  // namespace mirage::test
