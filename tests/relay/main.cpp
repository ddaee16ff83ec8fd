// mirage-relay: a real TCP connection between two programs, shaped like a link: delay, jitter,
// rate, an outage. What a modelled link computes happens here in real time.
//
//   viewer -> accept -> up (ShapedDirection) -> server;  server -> down (ShapedDirection) -> viewer

#include <arpa/inet.h>
#include <fcntl.h>
#include <netinet/tcp.h>
#include <poll.h>
#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <csignal>
#include <cstdio>
#include <fstream>
#include <list>
#include <vector>

#include "protocol/base/cli.h"
#include "protocol/base/clock.h"
#include "protocol/base/resources.h"
#include "tests/relay/shaped_direction.h"

namespace mirage {
namespace {

constexpr std::int64_t kLongestWaitUs = 100'000;

/// A relayed connection: two sockets, and the bytes under way between them.
struct Relayed {
  Relayed(int viewer, int server, const LinkShape& shape)
      : sockets{viewer, server}, ways{ShapedDirection(shape), ShapedDirection(shape)} {}
  std::array<int, 2> sockets;
  std::array<ShapedDirection, 2> ways;  ///< from sockets[i] to the other
  std::array<std::string, 2> arrived;   ///< from ways[i], not written yet
  bool over = false;
};

int connected_to(const sockaddr_in& at) {
  const int out = socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0);
  if (connect(out, reinterpret_cast<const sockaddr*>(&at), sizeof(at)) == 0) return out;
  close(out);
  return -1;
}

void make_ready(int socket) {
  const int on = 1;
  setsockopt(socket, IPPROTO_TCP, TCP_NODELAY, &on, sizeof(on));
  fcntl(socket, F_SETFL, O_NONBLOCK);
}

// Takes in as much as the link wants, and passes on what has arrived.
void carry(Relayed& c, std::int64_t now_us) {
  std::array<char, 65536> buffer{};
  for (std::size_t i = 0; i < 2; ++i) {
    const std::size_t most = std::min(buffer.size(), c.ways[i].wants());
    const ssize_t n = most > 0 ? recv(c.sockets[i], buffer.data(), most, 0) : -1;
    if (n > 0) c.ways[i].put(buffer.data(), static_cast<std::size_t>(n), now_us);
    if (n == 0) c.over = true;
    c.arrived[i] += c.ways[i].take(now_us);
    if (c.arrived[i].empty()) continue;
    const ssize_t sent =
        send(c.sockets[1 - i], c.arrived[i].data(), c.arrived[i].size(), MSG_NOSIGNAL);
    if (sent > 0) c.arrived[i].erase(0, static_cast<std::size_t>(sent));
  }
}

std::int64_t wait_us(const std::list<Relayed>& all, std::int64_t now_us) {
  std::int64_t next = now_us + kLongestWaitUs;
  for (const Relayed& c : all) {
    for (const ShapedDirection& way : c.ways) next = std::min(next, way.next_us());
  }
  return std::max<std::int64_t>(next - now_us, 0);
}

void relay(int listener, const sockaddr_in& server, const LinkShape& shape) {
  const SteadyClock clock;
  std::list<Relayed> all;
  for (;;) {
    std::vector<pollfd> polled = {{listener, POLLIN, 0}};
    for (const Relayed& c : all) {
      for (std::size_t i = 0; i < 2; ++i) {
        const int reads = c.ways[i].wants() > 0 ? POLLIN : 0;
        const int writes = c.arrived[1 - i].empty() ? 0 : POLLOUT;
        polled.push_back({c.sockets[i], static_cast<short>(reads | writes), 0});
      }
    }
    const std::int64_t us = wait_us(all, clock.now_us());
    const timespec wait{us / 1'000'000, us % 1'000'000 * 1000};
    ppoll(polled.data(), polled.size(), &wait, nullptr);
    if (polled[0].revents & POLLIN) {
      const int viewer = accept4(listener, nullptr, nullptr, SOCK_CLOEXEC);
      const int to = viewer < 0 ? -1 : connected_to(server);
      if (to < 0) {
        if (viewer >= 0) close(viewer);
      } else {
        make_ready(viewer);
        make_ready(to);
        all.emplace_back(viewer, to, shape);
      }
    }
    for (Relayed& c : all) carry(c, clock.now_us());
    all.remove_if([](const Relayed& c) {
      if (c.over) {
        for (const int socket : c.sockets) close(socket);
      }
      return c.over;
    });
  }
}

int run(int argc, char** argv) {
  CLI::App app("A TCP connection shaped as a link: viewer -> here -> server.", "mirage-relay");
  int port = 0, to = 0;
  std::string port_file;
  double rtt_ms = 0;
  LinkShape shape;
  app.add_option("--listen", port, "port on this machine; 0 takes any free one");
  app.add_option("--to", to, "the server's port on this machine")->required();
  app.add_option("--port-file", port_file, "write the port here once ready");
  app.add_option("--rtt", rtt_ms, "round trip, ms, half of it each way")
      ->check(CLI::Range(0.0, 1e5));
  app.add_option("--jitter", shape.jitter_ms, "added to each way, ms, from 0 to this")
      ->check(CLI::Range(0.0, 1e5));
  app.add_option("--rate", shape.rate_mbps, "Mbit/s each way; 0: any")->check(CLI::Range(0.0, 1e5));
  app.add_option("--outage-at", shape.outage_at_s, "seconds after the start")
      ->check(CLI::Range(0.0, 1e6));
  app.add_option("--outage-for", shape.outage_for_s, "seconds without a link")
      ->check(CLI::Range(0.0, 1e6));
  app.add_option("--seed", shape.seed, "of the jitter");
  CLI11_PARSE(app, argc, argv);
  shape.delay_ms = rtt_ms / 2;
  std::signal(SIGPIPE, SIG_IGN);
  sockaddr_in here{};
  here.sin_family = AF_INET;
  here.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
  sockaddr_in server = here;
  here.sin_port = htons(static_cast<std::uint16_t>(port));
  server.sin_port = htons(static_cast<std::uint16_t>(to));
  const int listener = socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0);
  const int on = 1;
  setsockopt(listener, SOL_SOCKET, SO_REUSEADDR, &on, sizeof(on));
  socklen_t size = sizeof(here);
  if (bind(listener, reinterpret_cast<sockaddr*>(&here), size) != 0 || listen(listener, 64) != 0) {
    return fail(
        make_error(ErrorId::kNetworkListen, "cannot listen on port " + std::to_string(port)));
  }
  getsockname(listener, reinterpret_cast<sockaddr*>(&here), &size);
  if (!port_file.empty()) std::ofstream(port_file) << ntohs(here.sin_port) << '\n';
  std::printf("ready ws://127.0.0.1:%d\n", ntohs(here.sin_port));
  std::fflush(stdout);
  relay(listener, server, shape);
  return 0;
}

}  // namespace
}  // namespace mirage

int main(int argc, char** argv) {
  return mirage::run_program([&] { return mirage::run(argc, argv); });
}
