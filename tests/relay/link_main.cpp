// mirage-link: two network namespaces with a link between them that delays, loses and reorders
// packets, and a program in each. TCP itself is the kernel's own.
//
//   near program -> TUN -> up (PacketDirection) -> TUN -> far program, at 10.213.0.1

#include <fcntl.h>
#include <linux/if.h>
#include <linux/if_tun.h>
#include <poll.h>
#include <sched.h>
#include <sys/ioctl.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <csignal>
#include <cstdio>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <thread>

#include "protocol/base/cli.h"
#include "protocol/base/clock.h"
#include "protocol/base/resources.h"
#include "protocol/base/result.h"
#include "tests/relay/packet_direction.h"

namespace mirage {
namespace {

constexpr std::int64_t kLongestWaitUs = 20'000;
constexpr int kMaxPacket = 65536;

struct Options {
  std::string far, near, until, stats;
  double rtt_ms = 0;
  PacketShape shape;
};

/// An end of the link: a namespace, and the device whose packets are carried.
struct End {
  int space = -1, tun = -1;
};

Error no_link(const std::string& what) {
  return make_error(ErrorId::kNetworkListen, what + ": " + std::strerror(errno),
                    "network namespaces and /dev/net/tun are root's");
}

/// Leaves the process in the new namespace.
Result<End> make_end(const std::string& address) {
  End out;
  if (unshare(CLONE_NEWNET) != 0) return no_link("no network namespace can be made");
  out.space = open("/proc/self/ns/net", O_RDONLY | O_CLOEXEC);
  out.tun = open("/dev/net/tun", O_RDWR | O_CLOEXEC | O_NONBLOCK);
  ifreq request{};
  request.ifr_flags = IFF_TUN | IFF_NO_PI;
  std::strcpy(request.ifr_name, "mirage0");
  if (out.space < 0 || out.tun < 0 || ioctl(out.tun, TUNSETIFF, &request) != 0) {
    return no_link("no TUN device can be made");
  }
  const std::string up = "ip link set lo up && ip addr add " + address +
                         "/24 dev mirage0 && ip link set mirage0 txqueuelen 1000 up";
  if (std::system(up.c_str()) != 0) {
    return make_error(ErrorId::kNetworkListen, "'ip' cannot set up the device",
                      "it is in the package iproute2");
  }
  return out;
}

pid_t start_in(const End& end, const std::string& command) {
  const pid_t pid = fork();
  if (pid != 0) return pid;
  setpgid(0, 0);
  if (setns(end.space, CLONE_NEWNET) == 0) {
    execl("/bin/sh", "sh", "-c", command.c_str(), nullptr);
  }
  _exit(127);
}

/// Takes in what was sent, and passes on what has arrived.
void carry(int from, int to, PacketDirection& way, std::int64_t now_us) {
  std::array<char, kMaxPacket> buffer;
  for (ssize_t n = 0; (n = read(from, buffer.data(), buffer.size())) > 0;) {
    way.put(std::string(buffer.data(), static_cast<std::size_t>(n)), now_us);
  }
  while (const std::optional<std::string> packet = way.take(now_us)) {
    if (write(to, packet->data(), packet->size()) < 0) return;  // the device is down
  }
}

/// Carries packets until the near program ends. Returns its exit code.
int carry_until_end(const End& far, const End& near, std::array<PacketDirection, 2>& ways,
                    const Options& o) {
  const SteadyClock clock;
  pid_t running = o.until.empty() ? start_in(near, o.near) : 0;
  for (;;) {
    if (running == 0 && std::filesystem::exists(o.until)) running = start_in(near, o.near);
    int status = 0;
    if (running > 0 && waitpid(running, &status, WNOHANG) == running) {
      return WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
    }
    std::int64_t now_us = clock.now_us();
    const std::int64_t next_us =
        std::min({ways[0].next_us(), ways[1].next_us(), now_us + kLongestWaitUs});
    const std::int64_t wait_us = std::max<std::int64_t>(next_us - now_us, 0);
    const timespec wait{0, wait_us * 1000};
    std::array<pollfd, 2> polled = {pollfd{near.tun, POLLIN, 0}, pollfd{far.tun, POLLIN, 0}};
    ppoll(polled.data(), polled.size(), &wait, nullptr);
    now_us = clock.now_us();
    carry(near.tun, far.tun, ways[0], now_us);
    carry(far.tun, near.tun, ways[1], now_us);
  }
}

nlohmann::json told(const PacketDirection::Counts& counts) {
  return {{"packets", counts.packets},
          {"lost", counts.lost},
          {"dropped", counts.dropped},
          {"late", counts.late}};
}

int run(int argc, char** argv) {
  CLI::App app(
      "Runs two programs with a link between them that delays, loses and reorders packets.",
      "mirage-link");
  Options o;
  app.add_option("--far", o.far, "command at the far end, which is 10.213.0.1")->required();
  app.add_option("--near", o.near, "command at the near end; the link ends with it")->required();
  app.add_option("--until", o.until, "the near command starts once this file is there");
  app.add_option("--stats", o.stats, "write here, as JSON, what became of the packets");
  app.add_option("--rtt", o.rtt_ms, "round trip, ms")->check(CLI::Range(0.0, 1e4));
  app.add_option("--rate", o.shape.rate_mbps, "Mbit/s each way; 0: any")
      ->check(CLI::Range(0.0, 1e4));
  app.add_option("--loss", o.shape.loss_percent, "percent of packets, each way")
      ->check(CLI::Range(0.0, 100.0));
  app.add_option("--reorder", o.shape.reorder_percent, "percent of packets that come 5 ms late")
      ->check(CLI::Range(0.0, 100.0));
  app.add_option("--buffer-ms", o.shape.buffer_ms, "what may wait to be sent, at the rate")
      ->check(CLI::Range(0.0, 1e4));
  app.add_option("--seed", o.shape.seed, "of losses");
  CLI11_PARSE(app, argc, argv);
  o.shape.delay_ms = o.rtt_ms / 2;
  const Result<End> far = make_end("10.213.0.1");
  if (!far) return fail(far.error());
  const Result<End> near = make_end("10.213.0.2");
  if (!near) return fail(near.error());
  PacketShape down = o.shape;
  ++down.seed;
  std::array<PacketDirection, 2> ways = {PacketDirection(o.shape), PacketDirection(down)};
  const pid_t server = start_in(*far, o.far);
  const int code = carry_until_end(*far, *near, ways, o);
  kill(-server, SIGTERM);
  waitpid(server, nullptr, 0);
  if (!o.stats.empty()) {
    std::ofstream(o.stats)
        << nlohmann::json{{"up", told(ways[0].counts())}, {"down", told(ways[1].counts())}}.dump(2)
        << '\n';
  }
  return code;
}

}  // namespace
}  // namespace mirage

int main(int argc, char** argv) {
  return mirage::run_program([&] { return mirage::run(argc, argv); });
}
