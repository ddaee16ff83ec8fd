// N5: a server process is killed while it makes tiles; the client is in this process, with the
// shipped link, in real time.
#include "tests/extreme/network_server_case.h"

#include <fcntl.h>
#include <netinet/in.h>
#include <sys/resource.h>
#include <sys/socket.h>
#include <unistd.h>

#include <chrono>
#include <cmath>
#include <csignal>
#include <memory>
#include <thread>

#include "client/frame/planned_frame.h"
#include "client/native/native_link.h"
#include "client/scene/scene_view.h"
#include "client/session/client_session.h"
#include "client/session/tile_sink.h"
#include "protocol/base/clock.h"
#include "protocol/base/quantile.h"
#include "tests/support/process.h"
#include "tests/support/rig.h"

namespace mirage::extreme {
using namespace test;
namespace {

constexpr const char* kScene = "builtin:clutter?objects=40";
constexpr std::int64_t kFrameUs = 33'333;

/// Listens where the server was, hangs up on everyone, and notes when they came.
class Doorman {
 public:
  explicit Doorman(int port) : socket_(socket(AF_INET, SOCK_STREAM | SOCK_NONBLOCK, 0)) {
    const int yes = 1;
    setsockopt(socket_, SOL_SOCKET, SO_REUSEADDR, &yes, sizeof yes);
    sockaddr_in address{};
    address.sin_family = AF_INET;
    address.sin_port = htons(static_cast<std::uint16_t>(port));
    address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    ready_ = bind(socket_, reinterpret_cast<sockaddr*>(&address), sizeof address) == 0 &&
             listen(socket_, 16) == 0;
  }
  ~Doorman() { close(socket_); }
  bool ready() const { return ready_; }
  void look(double now_s) {
    for (int guest; (guest = accept(socket_, nullptr, nullptr)) >= 0; close(guest)) {
      came_s.push_back(now_s);
    }
  }
  std::vector<double> came_s;

 private:
  int socket_;
  bool ready_ = false;
};

/// The client's frame loop, without a picture.
class Client {
 public:
  explicit Client(int port) : link({"127.0.0.1", port, false}), session(link, options(), sink()) {
    camera.width = 320;
    camera.height = 180;
  }
  static ClientOptions options() {
    ClientOptions o;
    o.mesh_radii = 0;  // always tiles
    return o;
  }
  TileSink sink() {
    TileSink s;
    s.tile = [this](const TileRecord&, const AtlasPlanes&) { ++tiles; };
    return s;
  }
  /// Runs a frame. Its cost is CPU time; if the thread has waited for something, it is all of the
  /// time. Time in which other programs had the processor does not count.
  void frame() {
    rusage before{}, after{};
    getrusage(RUSAGE_THREAD, &before);
    const double cpu = thread_seconds();
    const std::int64_t began = clock.now_us();
    (void)session.receive(began);
    const HomeView& home = session.scene().home;
    // The eye goes round the middle of the room, so that there is always something to ask for.
    const double angle = 0.8e-6 * static_cast<double>(began);
    const glm::dvec3 off = home.eye - home.target;
    camera.pose =
        look_at(home.target + glm::dvec3(std::sin(angle) * off.z, off.y, std::cos(angle) * off.z),
                home.target);
    camera.fit_depth_range(session.scene().bounds_center, session.scene().bounds_radius);
    list = session.frame(camera, began).list;
    getrusage(RUSAGE_THREAD, &after);
    const bool waited = after.ru_nvcsw != before.ru_nvcsw;
    const double wall_ms = static_cast<double>(clock.now_us() - began) * 1e-3;
    cost_ms.push_back(waited ? wall_ms : 1000 * (thread_seconds() - cpu));
    const std::int64_t left = kFrameUs - (clock.now_us() - began);
    if (left > 0) std::this_thread::sleep_for(std::chrono::microseconds(left));
  }
  double now_s() const { return static_cast<double>(clock.now_us()) * 1e-6; }

  SteadyClock clock;
  NativeLink link;
  ClientSession session;
  Camera camera;
  DrawList list;
  std::vector<double> cost_ms;
  int tiles = 0;
};

Outcome killed_server(const Conditions& conditions) {
  Checks checks;
  auto server = std::make_unique<test::Server>(kScene);
  if (!server->ready()) {
    checks.failed("no server: " + server->log());
    return checks.outcome();
  }
  const int port = server->port();
  Client client(port);
  while (client.now_s() < 20 && client.tiles < 30) client.frame();
  client.cost_ms.clear();
  for (int i = 0; i < 60; ++i) client.frame();
  const double usual_ms = quantile(client.cost_ms, 0.99);
  // Kills the server in the middle of a tile.
  for (int i = 0; i < 300 && client.session.in_flight() == 0; ++i) client.frame();
  const std::size_t under_way = client.session.in_flight();
  server->stop(SIGKILL);
  client.cost_ms.clear();
  Doorman doorman(port);
  if (!doorman.ready()) checks.failed("the server's port is not free");
  const double killed_s = client.now_s(), gone_s = conditions.quick ? 7 : 14;
  int frames = 0;
  while (client.now_s() - killed_s < gone_s) {
    client.frame();
    doorman.look(client.now_s());
    ++frames;
  }
  const double wanted = gone_s * 1e6 / static_cast<double>(kFrameUs);
  int shrunk = 0;
  double longest = 0;
  for (std::size_t i = 2; i < doorman.came_s.size(); ++i) {
    const double pause = doorman.came_s[i] - doorman.came_s[i - 1];
    const double before = doorman.came_s[i - 1] - doorman.came_s[i - 2];
    // The pause is read once a frame; at its longest it stays as it is.
    shrunk += pause > std::min(1.6 * before, 4.9) - 0.1 ? 0 : 1;
    longest = std::max(longest, pause);
  }
  const double gone_ms = quantile(client.cost_ms, 0.99);
  const std::size_t shown = client.list.impostors.size();
  checks.at_least("tiles under way when it was killed", static_cast<double>(under_way), 1);
  checks.at_most("frame p99 more by, ms", gone_ms - usual_ms, 1);
  checks.at_least("share of the frames wanted", frames / wanted, 0.9);
  checks.at_least("impostors still drawn", static_cast<double>(shown), 1);
  checks.at_least("tries to reconnect", static_cast<double>(doorman.came_s.size()), 4);
  checks.at_most("tries to reconnect", static_cast<double>(doorman.came_s.size()), 12);
  checks.equal("pauses that did not grow", shrunk, 0);
  checks.at_most("longest pause, s", longest, 6);
  return checks.outcome();
}

}  // namespace

Case killed_server_case() {
  return {"N5",
          "server killed (SIGKILL) while it makes a tile",
          "frame rate kept, reconnect with backoff",
          killed_server,
          120,
          4096,
          true};
}

}  // namespace mirage::extreme
