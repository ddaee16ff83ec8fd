#include "tests/extreme/wire_server_cases.h"

#include <chrono>
#include <memory>
#include <thread>

#include "client/frame/planned_frame.h"
#include "client/native/native_link.h"
#include "client/scene/scene_view.h"
#include "client/session/client_session.h"
#include "client/session/session_options.h"
#include "client/session/tile_sink.h"
#include "protocol/base/clock.h"
#include "protocol/base/error.h"
#include "tests/extreme/peak_memory.h"
#include "tests/extreme/wire_samples.h"
#include "tests/support/process.h"
#include "tests/support/protocol_samples.h"
#include "tests/support/raw_peer.h"

namespace mirage::extreme {
namespace {

using test::frame;
using test::frame_head;
using test::RawPeer;
using test::upgrade;

constexpr const char* kServedScene = "builtin:knot?tubular=32&radial=12";
constexpr double kServerMegabyte = 1024.0 * 1024.0;

std::string text_of(const Bytes& bytes) { return {bytes.begin(), bytes.end()}; }

wire::HelloT hello() {
  wire::HelloT m;
  m.version_min = m.version_max = limits::kProtocolVersion;
  m.codecs = {static_cast<std::uint8_t>(TileCodec::kRaw),
              static_cast<std::uint8_t>(TileCodec::kZstd)};
  return m;
}

/// A connection that has become a WebSocket.
std::unique_ptr<RawPeer> websocket(int port) {
  auto peer = std::make_unique<RawPeer>(port);
  peer->say(upgrade("13", test::kUpgradeKey));
  if (peer->hear().find("101") == std::string::npos) return nullptr;
  return peer;
}

/// Returns the code of the close packet among what the server says; 0: none.
int close_code_of(RawPeer& peer) {
  std::string heard;
  for (;;) {
    const std::string more = peer.hear();
    if (more.empty()) break;
    heard += more;
  }
  for (std::size_t i = 0; i + 4 <= heard.size(); ++i) {
    if (static_cast<unsigned char>(heard[i]) == 0x88) {
      return static_cast<unsigned char>(heard[i + 2]) << 8 |
             static_cast<unsigned char>(heard[i + 3]);
    }
  }
  return 0;
}

/// Returns the milliseconds until a new client has its first tile; negative: it got none.
double first_tile_ms(int port) {
  const SteadyClock clock;
  NativeLink link({"127.0.0.1", port, false});
  if (!link.wait_connected(10'000)) return -1;
  int tiles = 0;
  TileSink sink;
  sink.tile = [&](const TileRecord&, const AtlasPlanes&) { ++tiles; };
  ClientOptions options;
  options.mesh_radii = 0;
  ClientSession session(link, options, sink);
  Camera camera;
  camera.width = 160;
  camera.height = 120;
  while (tiles == 0 && clock.now_us() < 20'000'000) {
    if (!session.receive(clock.now_us()) && !link.connected()) return -1;
    const HomeView& home = session.scene().home;
    camera.pose = look_at(home.eye, home.target);
    camera.fit_depth_range(session.scene().bounds_center, session.scene().bounds_radius);
    session.frame(camera, clock.now_us());
    link.wait_message(5);
  }
  return tiles > 0 ? static_cast<double>(clock.now_us()) * 1e-3 : -1;
}

/// Returns the mean of three clients, one after the other; negative: one of them got none.
double mean_first_tile_ms(int port) {
  double sum = 0;
  for (int i = 0; i < 3; ++i) {
    const double ms = first_tile_ms(port);
    if (ms < 0) return ms;
    sum += ms;
  }
  return sum / 3;
}

/// Holds a connection open by sending a byte now and then.
struct Dribbler {
  std::unique_ptr<RawPeer> peer;
  std::string text;  ///< bytes it sends
  std::size_t said = 0;
  void dribble() {
    if (peer) peer->say(std::string(1, text[said++ % text.size()]));
  }
};

Outcome slow_loris(const Conditions& conditions) {
  // Usual times are measured on a server that is left in peace, by turns, because the machine's
  // load drifts.
  const test::Server server(kServedScene), in_peace(kServedScene);
  Checks checks;
  for (const test::Server* each : {&server, &in_peace}) {
    if (!each->ready()) {
      checks.failed("no server: " + each->log());
      return checks.outcome();
    }
    first_tile_ms(each->port());
  }
  const std::size_t before = peak_bytes_of(server.pid());
  std::vector<Dribbler> handshakes, silent, messages;
  const int each = 60;
  const std::string request = upgrade("13", test::kUpgradeKey);
  const std::string batch = text_of(encode_message(test::sample_request_batch()));
  for (int i = 0; i < each; ++i) {
    handshakes.push_back({std::make_unique<RawPeer>(server.port()), request, 0});
    // Says hello a byte at a time.
    const std::string greeting = text_of(encode_message(hello()));
    silent.push_back({websocket(server.port()), frame(2, greeting), 0});
    // Greets like any client, and then sends a message of 200 KB a byte at a time.
    auto peer = websocket(server.port());
    if (peer) peer->say(frame(2, greeting) + frame_head(2, 200'000));
    messages.push_back({std::move(peer), batch, 0});
  }
  const int seconds = conditions.quick ? 16 : 40;
  double worst_ms = 0, usual_ms = 0;
  int unserved = 0;
  for (int s = 0; s < seconds; ++s) {
    for (auto* list : {&handshakes, &silent, &messages}) {
      for (Dribbler& d : *list) d.dribble();
    }
    if (s % 4 == 1) {
      usual_ms = std::max(usual_ms, mean_first_tile_ms(in_peace.port()));
      const double ms = mean_first_tile_ms(server.port());
      unserved += ms < 0 ? 1 : 0;
      worst_ms = std::max(worst_ms, ms);
    }
    std::this_thread::sleep_for(std::chrono::seconds(1));
  }
  int held = 0;
  for (auto* list : {&handshakes, &silent}) {
    for (Dribbler& d : *list) held += d.peer && !d.peer->closed() ? 1 : 0;
  }
  const double grown = static_cast<double>(peak_bytes_of(server.pid()) - before) / kServerMegabyte;
  checks.equal("clients not served beside them", unserved, 0);
  checks.at_most("time to the first tile, times the usual", worst_ms / usual_ms, 10);
  checks.equal("ungreeted connections held for good", held, 0);
  checks.at_most("server memory grown by, MB", grown, 64);
  return checks.outcome();
}

}  // namespace

void websocket_lengths(Checks& checks) {
  // A thread's first arena takes 128 MB of addresses, whenever that thread first has work.
  const test::Server server(kServedScene, {}, {"MALLOC_ARENA_MAX=1"});
  if (!server.ready()) return checks.failed("no server: " + server.log());
  first_tile_ms(server.port());
  const std::size_t before = peak_bytes_of(server.pid());
  int kept = 0, tried = 0;
  std::vector<std::unique_ptr<RawPeer>> peers;
  for (const std::uint64_t length :
       {std::uint64_t{limits::kMaxMessageBytes} + 1, std::uint64_t{1} << 24, std::uint64_t{1} << 31,
        std::uint64_t{1} << 32, (std::uint64_t{1} << 63) - 1, std::uint64_t{1} << 63, UINT64_MAX}) {
    auto peer = websocket(server.port());
    if (!peer) continue;
    peer->say(frame_head(2, length));
    // Sends just enough to go beyond what is allowed.
    const std::string part(64 * 1024, 'x');
    for (int i = 0; i < 6; ++i) peer->say(part);
    peers.push_back(std::move(peer));
    ++tried;
  }
  // The server says so at once; it closes the socket when the peer has not answered for five
  // seconds.
  for (int i = 0; i < 80; ++i) {
    std::this_thread::sleep_for(std::chrono::milliseconds(100));
    kept = 0;
    for (const auto& peer : peers) kept += peer->closed() ? 0 : 1;
    if (kept == 0) break;
  }
  const double grown = static_cast<double>(peak_bytes_of(server.pid()) - before) / kServerMegabyte;
  checks.equal("WebSocket lengths tried", tried, 7);
  checks.equal("connections kept", kept, 0);
  checks.at_most("server memory grown by, MB", grown, 8);
  checks.at_least("first tile for another client, ms", first_tile_ms(server.port()), 0);
}

void versions_to_server(Checks& checks) {
  const test::Server server(kServedScene);
  if (!server.ready()) return checks.failed("no server: " + server.log());
  const int expected = close_code(ErrorId::kWireVersion);
  int wrong = 0;
  constexpr int kOwn = limits::kProtocolVersion;
  for (const int version : {0, kOwn - 1, kOwn + 1, 99, 255}) {
    const auto peer = websocket(server.port());
    Bytes bytes = encode_message(hello());
    bytes[2] = static_cast<std::uint8_t>(version);
    peer->say(frame(2, text_of(bytes)));
    wrong += close_code_of(*peer) == expected ? 0 : 1;
  }
  for (const int version : {0, kOwn - 1, kOwn + 1, 65535}) {
    const auto peer = websocket(server.port());
    wire::HelloT m = hello();
    m.version_min = m.version_max = static_cast<std::uint32_t>(version);
    peer->say(frame(2, text_of(encode_message(std::move(m)))));
    wrong += close_code_of(*peer) == expected ? 0 : 1;
  }
  checks.equal("connections not closed for the version", wrong, 0);
  checks.at_least("first tile for another client, ms", first_tile_ms(server.port()), 0);
}

Case slow_loris_case() {
  return {"R6",
          "180 connections that say a byte a second",
          "a client beside them served within 10 times the usual, memory under the cap, "
          "ungreeted ones closed",
          slow_loris,
          180,
          4096,
          true};
}

}  // namespace mirage::extreme
