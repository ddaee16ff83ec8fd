// Operations: health and metrics at an address of their own, logs, the service manager, --doctor,
// and that the files of packaging/ match the programs.
#include <gtest/gtest.h>
#include <sys/socket.h>
#include <sys/un.h>
#include <unistd.h>

#include <csignal>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <regex>
#include <set>
#include <thread>

#include "tests/support/metrics.h"
#include "tests/support/process.h"
#include "tests/support/raw_peer.h"

namespace mirage::test {
namespace {

namespace fs = std::filesystem;
const fs::path kPackaging = fs::path(MIRAGE_SOURCE_DIR) / "packaging";

/// Returns the answer to a GET, head and body.
std::string get(int port, const std::string& path, const std::string& headers = "") {
  RawPeer peer(port);
  peer.say("GET " + path + " HTTP/1.1\r\nHost: x\r\n" + headers + "Connection: close\r\n\r\n");
  std::string text;
  for (std::string part = peer.hear(); !part.empty(); part = peer.hear()) text += part;
  return text;
}

int status_of(const std::string& answer) {
  return answer.size() > 12 ? std::atoi(answer.c_str() + 9) : 0;
}

/// A client that says something else than hello, and is closed for it.
void speak_nonsense(int port) {
  RawPeer peer(port);
  peer.say(
      "GET / HTTP/1.1\r\nHost: x\r\nUpgrade: websocket\r\nConnection: Upgrade\r\n"
      "Sec-WebSocket-Version: 13\r\nSec-WebSocket-Protocol: mirage\r\n"
      "Sec-WebSocket-Key: MDAwMDAwMDAwMDAwMDAwMA==\r\n\r\n");
  if (peer.hear().empty()) return;  // its address is refused by now
  peer.say("\x82\x84maskwhat");
  peer.hear();
}

/// Returns the port that the server announces for operators.
int admin_port(const Server& server) {
  std::smatch found;
  const std::string log = server.log();
  const std::regex said("metrics and health are at ws://127.0.0.1:([0-9]+)");
  return std::regex_search(log, found, said) ? std::stoi(found[1]) : 0;
}

TEST(Operations, HealthAndMetricsHaveAnAddressOfTheirOwn) {
  const Server server("builtin:knot", {"--admin", "0"});
  ASSERT_TRUE(server.ready()) << server.log();
  const int admin = admin_port(server);
  ASSERT_NE(admin, 0) << server.log();
  EXPECT_EQ(status_of(get(admin, "/healthz")), 200);
  const std::string metrics = get(admin, "/metrics");
  EXPECT_EQ(status_of(metrics), 200);
  EXPECT_NE(metrics.find("mirage_stage_seconds_bucket{stage=\"whole\",le=\"+Inf\"} 0"),
            std::string::npos)
      << metrics;
  const std::string ready = get(admin, "/readyz");
  const auto told = nlohmann::json::parse(ready.substr(ready.find("\r\n\r\n")));
  EXPECT_NE(server.log().find("revision=" + told["revision"].get<std::string>()),
            std::string::npos);
  EXPECT_NE(server.log().find("profile=" + told["profile"].get<std::string>()), std::string::npos);
  EXPECT_EQ(told["draining"], false);
  EXPECT_EQ(status_of(get(admin, "/v1/tile/1/2")), 404);
  EXPECT_EQ(status_of(get(server.port(), "/metrics")), 404) << "not for everybody";
  EXPECT_EQ(status_of(get(server.port(), "/readyz")), 200);
}

TEST(Operations, TheServiceManagerIsTold) {
  const std::string path = scratch_folder() + "/notify";
  const int socket = ::socket(AF_UNIX, SOCK_DGRAM, 0);
  sockaddr_un at{};
  at.sun_family = AF_UNIX;
  std::strncpy(at.sun_path, path.c_str(), sizeof(at.sun_path) - 1);
  ASSERT_EQ(bind(socket, reinterpret_cast<sockaddr*>(&at), sizeof(at)), 0);
  const timeval patience{5, 0};
  setsockopt(socket, SOL_SOCKET, SO_RCVTIMEO, &patience, sizeof(patience));
  const auto told = [&](const std::string& wanted) {  // within the next lines
    for (int i = 0; i < 50; ++i) {
      char text[512] = {};
      if (recv(socket, text, sizeof(text) - 1, 0) <= 0) return false;
      if (std::string(text).find(wanted) != std::string::npos) return true;
    }
    return false;
  };
  Server server("builtin:knot", {}, {"NOTIFY_SOCKET=" + path});
  ASSERT_TRUE(server.ready()) << server.log();
  EXPECT_TRUE(told("READY=1"));
  EXPECT_TRUE(told("WATCHDOG=1"));
  kill(server.pid(), SIGHUP);
  EXPECT_TRUE(told("RELOADING=1\nMONOTONIC_USEC="));
  EXPECT_TRUE(told("READY=1"));
  std::thread end([&] { EXPECT_EQ(server.stop(SIGTERM), 0); });
  EXPECT_TRUE(told("STOPPING=1"));
  end.join();
  close(socket);
}

TEST(Operations, LogsAreJsonOnRequestWithThePeer) {
  const Server server("builtin:knot", {"--log-format", "json"});
  ASSERT_TRUE(server.ready()) << server.log();
  speak_nonsense(server.port());
  bool named = false;
  std::istringstream lines(server.log());
  for (std::string line; std::getline(lines, line);) {
    if (line.rfind("ready ", 0) == 0) continue;
    const auto j = nlohmann::json::parse(line, nullptr, false);
    ASSERT_TRUE(j.is_object()) << line;
    for (const char* key : {"time", "level", "message"}) EXPECT_TRUE(j.contains(key)) << line;
    named = named || (j.value("peer", "") == "127.0.0.1" && j.value("connection", 0) > 0);
  }
  EXPECT_TRUE(named) << server.log();
}

TEST(Operations, APeerCannotFillTheLog) {
  const Server server("builtin:knot");
  ASSERT_TRUE(server.ready()) << server.log();
  for (int i = 0; i < 400; ++i) {
    speak_nonsense(server.port());
  }
  const std::string log = server.log();
  EXPECT_LT(std::count(log.begin(), log.end(), '\n'), 300);
}

TEST(Operations, TheDoctorLooksAtAll) {
  const std::string folder = scratch_folder();
  const Finished well = run({binary("mirage-server"), "--doctor", "--listen", "127.0.0.1:0",
                             "--cache-dir", folder + "/cache"});
  EXPECT_EQ(well.exit_code, 0) << well.output;
  for (const char* line :
       {"ok    device", "descriptors", "ok    cache", "certificate", "store", "warn  tokens",
        "ok    scene", "ok    renderer", "ok    encoders", "ok    address", "ok    tile"}) {
    EXPECT_NE(well.output.find(line), std::string::npos) << line << "\n" << well.output;
  }
  const Server taken("builtin:knot");
  const Finished ill = run({binary("mirage-server"), "builtin:nosuch", "--doctor", "--cache-dir",
                            "/proc/nowhere", "--store", "redis://127.0.0.1:1"});
  EXPECT_EQ(ill.exit_code, 1) << ill.output;
  EXPECT_NE(ill.output.find("FAIL  cache"), std::string::npos) << ill.output;
  EXPECT_NE(ill.output.find("FAIL  scene"), std::string::npos) << ill.output;
  EXPECT_NE(ill.output.find("warn  store"), std::string::npos) << ill.output;
  const Finished port = run({binary("mirage-server"), "--doctor", "--listen",
                             "127.0.0.1:" + std::to_string(taken.port())});
  EXPECT_EQ(port.exit_code, 5) << port.output;
  EXPECT_NE(port.output.find("FAIL  address"), std::string::npos) << port.output;
}

/// Runs the server on a software renderer of Mesa, even on a machine with a card.
Finished on_the_cpu(const std::vector<std::string>& options,
                    const std::string& renderer = "llvmpipe") {
  const char* const vendor = "/usr/share/glvnd/egl_vendor.d/50_mesa.json";
  std::vector<std::string> command = {"/usr/bin/env",
                                      "LIBGL_ALWAYS_SOFTWARE=1",
                                      "GALLIUM_DRIVER=" + renderer,
                                      std::string("__EGL_VENDOR_LIBRARY_FILENAMES=") + vendor,
                                      binary("mirage-server"),
                                      "--listen",
                                      "127.0.0.1:0"};
  command.insert(command.end(), options.begin(), options.end());
  return run(command);
}

TEST(Operations, AServerThatRequiresACardEndsWithoutOne) {
  const Finished refused = on_the_cpu({"builtin:knot", "--require-gpu"});
  EXPECT_EQ(refused.exit_code, 4) << refused.output;
  EXPECT_NE(refused.output.find("error graphics-device: --require-gpu: llvmpipe"),
            std::string::npos)
      << refused.output;
  EXPECT_NE(refused.output.find("(hint: "), std::string::npos) << refused.output;
}

TEST(Operations, TheDoctorSaysWhyNoCardDraws) {
  const Finished told = on_the_cpu({"--doctor"});
  EXPECT_EQ(told.exit_code, 0) << told.output;
  EXPECT_NE(told.output.find("warn  card         the CPU draws: "), std::string::npos)
      << told.output;
  const Finished failed = on_the_cpu({"--doctor", "--require-gpu"});
  EXPECT_EQ(failed.exit_code, 4) << failed.output;
  EXPECT_NE(failed.output.find("FAIL  card"), std::string::npos) << failed.output;
}

// softpipe has OpenGL 3.3 without sample shading.
TEST(Operations, ADeviceWithoutSampleShadingServes) {
  const Finished drawn = on_the_cpu({"--doctor"}, "softpipe");
  EXPECT_EQ(drawn.exit_code, 0) << drawn.output;
  EXPECT_NE(drawn.output.find("ok    renderer     softpipe"), std::string::npos) << drawn.output;
  EXPECT_NE(drawn.output.find("ok    tile"), std::string::npos) << drawn.output;
}

TEST(Operations, TheReadyLineNamesTheEncoders) {
  const Server chosen("builtin:knot", {"--encoders", "3"});
  ASSERT_TRUE(chosen.ready()) << chosen.log();
  EXPECT_NE(chosen.log().find(" encoders=3 "), std::string::npos) << chosen.log();
  const Server unasked("builtin:knot", {"--device", "surfaceless"});  // a software renderer
  ASSERT_TRUE(unasked.ready()) << unasked.log();
  EXPECT_NE(unasked.log().find(" encoders=1 "), std::string::npos) << unasked.log();
}

TEST(Operations, TilesAreGotByHttp) {
  const Server server("builtin:knot", {"--metrics"});
  ASSERT_TRUE(server.ready()) << server.log();
  const std::string urls = scratch_folder() + "/urls";
  ASSERT_EQ(run({binary("mirage-load"), server.url(), "--duration", "1", "--path", "builtin:orbit",
                 "--rate", "2", "--urls", urls})
                .exit_code,
            0);
  std::ifstream file(urls);
  std::string path;
  ASSERT_TRUE(std::getline(file, path));
  const std::string first = get(server.port(), path), again = get(server.port(), path);
  EXPECT_EQ(status_of(first), 200);
  EXPECT_EQ(first, again);
  std::smatch tag;
  const std::regex etag("ETag: (\"[^\"]+\")", std::regex::icase);
  ASSERT_TRUE(std::regex_search(first, tag, etag)) << first.substr(0, 300);
  const std::string kept = get(server.port(), path, "If-None-Match: " + tag[1].str() + "\r\n");
  EXPECT_EQ(status_of(kept), 304);
  EXPECT_EQ(kept.size(), kept.find("\r\n\r\n") + 4) << "without a body";
  const double before = metrics(server)["tiles_rendered_total"];
  const std::string other =
      std::regex_replace(path, std::regex("\\.[0-9]+\\.3\\.zstd"), ".4.3.zstd");
  ASSERT_NE(other, path);
  EXPECT_EQ(status_of(get(server.port(), other)), 200) << "one that nobody asked for before";
  EXPECT_EQ(metrics(server)["tiles_rendered_total"], before + 1);
  EXPECT_EQ(status_of(get(server.port(), path + "x")), 404);
  EXPECT_EQ(status_of(get(server.port(), "/v1/tile/")), 404);
}

TEST(Operations, TheUnitIsGoodAndShutIn) {
  if (!fs::exists("/usr/bin/systemd-analyze")) GTEST_SKIP() << "systemd is not installed";
  const std::string unit = scratch_folder() + "/mirage-server.service";
  const std::string text = read_file((kPackaging / "systemd/mirage-server.service").string());
  std::ofstream(unit) << std::regex_replace(text, std::regex("/usr/bin/mirage-server"),
                                            binary("mirage-server"));
  const Finished verified = run({"/usr/bin/systemd-analyze", "verify", "--man=no", unit});
  EXPECT_EQ(verified.exit_code, 0) << verified.output;
  const Finished shut = run({"/usr/bin/systemd-analyze", "security", "--offline=true",
                             "--threshold=30", "--no-pager", unit});
  EXPECT_EQ(shut.exit_code, 0) << shut.output;
  std::smatch level;
  ASSERT_TRUE(std::regex_search(shut.output, level, std::regex("exposure level.*: ([0-9.]+)")));
  std::printf("exposure %s\n", level[1].str().c_str());
}

TEST(Operations, TheExampleConfigurationIsGood) {
  const std::string file = scratch_folder() + "/server.toml";
  std::ofstream(file) << read_file((kPackaging / "server.toml").string());
  const Finished checked = run({binary("mirage-server"), "--config", file, "--check-config"});
  EXPECT_EQ(checked.exit_code, 0) << checked.output;
  const Finished bad =
      run({binary("mirage-server"), "--config", file, "--check-config", "--log-format", "xml"});
  EXPECT_EQ(bad.exit_code, 2) << bad.output;
}

/// Returns the names of metrics in a text, without the suffixes that Prometheus adds for
/// histograms.
std::set<std::string> metric_names(const std::string& text) {
  std::set<std::string> out;
  const std::regex name("mirage_[a-z_]+");
  for (std::sregex_iterator at(text.begin(), text.end(), name), end; at != end; ++at) {
    out.insert(std::regex_replace(at->str(), std::regex("_(bucket|sum|count)$"), ""));
  }
  return out;
}

TEST(Operations, DashboardAndRulesNameWhatThereIs) {
  const Server server("builtin:knot", {"--metrics"});
  ASSERT_TRUE(server.ready()) << server.log();
  const std::string text = get(server.port(), "/metrics");
  const std::set<std::string> there = metric_names(text);
  const std::string dashboard = read_file((kPackaging / "grafana/mirage.json").string());
  const std::string rules = (kPackaging / "prometheus/mirage.rules.yml").string();
  EXPECT_TRUE(nlohmann::json::parse(dashboard, nullptr, false).is_object());
  std::size_t named = 0;
  for (const std::string& source : {dashboard, read_file(rules)}) {
    for (const std::string& name : metric_names(source)) {
      EXPECT_EQ(there.count(name), 1u) << name;
      ++named;
    }
  }
  EXPECT_GT(named, 25u);
  if (!fs::exists("/usr/bin/promtool")) GTEST_SKIP() << "promtool is not installed";
  const std::string file = scratch_folder() + "/metrics";
  std::ofstream(file) << text.substr(text.find("\r\n\r\n") + 4);
  const Finished good = run({"/bin/sh", "-c", "promtool check metrics < " + file});
  EXPECT_EQ(good.exit_code, 0) << good.output;
  const Finished checked = run({"/usr/bin/promtool", "check", "rules", rules});
  EXPECT_EQ(checked.exit_code, 0) << checked.output;
  const Finished tried = run(
      {"/usr/bin/promtool", "test", "rules", (kPackaging / "prometheus/mirage.test.yml").string()});
  EXPECT_EQ(tried.exit_code, 0) << tried.output;
}

}  // namespace
}  // namespace mirage::test
