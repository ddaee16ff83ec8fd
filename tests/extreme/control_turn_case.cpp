// C5: the link or the server gets worse for a while and then recovers. While it is worse, the rest
// of its capacity is used; soon afterwards the session is where it had been.

#include "tests/extreme/control_turn_case.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <string>

#include "tests/extreme/network_links.h"
#include "tests/support/rig.h"

namespace mirage::extreme {
using namespace test;
namespace {

constexpr double kBeforeS = 8, kWorseS = 10, kAgainS = 5, kAfterS = 8;
constexpr int kObjects = 150;
constexpr double kTurnTau = 0.001, kUsualTau = 1;

NetModel usual() {
  NetModel net;
  net.rtt_ms = 20;
  net.rate_mbps = 20;
  net.server_ms = 2;
  return net;
}

/// The weather while it is worse.
struct Turn {
  std::string name;
  NetModel worse;
  bool silent = false;  ///< nothing gets through at all
  double seconds = kWorseS;
};

Pose swaying_turn(double t) { return eye_at({4 * std::sin(0.7 * t), 1, 9}, {0, 0, -30}); }

class Walk {
 public:
  explicit Walk(double tau_px) : rig_(rig_scene({kObjects}), options(tau_px)) {
    rig_.camera.width = 1280;
    rig_.camera.height = 720;
  }
  void run(double seconds) { list_ = rig_.run(seconds, swaying_turn); }
  /// Runs for `seconds`. Returns the tiles that arrived a second.
  double tiles_a_second(double seconds) {
    const std::uint64_t before = rig_.session.tiles().received;
    run(seconds);
    return static_cast<double>(rig_.session.tiles().received - before) / seconds;
  }
  void worse(const Turn& turn) {
    rig_.link.change(turn.worse);
    if (turn.silent) gate_->close();
  }
  void as_before(const Turn& turn) {
    rig_.link.change(usual());
    if (turn.silent) gate_->open();
  }
  double tau_px() const { return rig_.session.tau_px(); }
  std::size_t placeholders() const { return list_.placeholders.size(); }

 private:
  RigOptions options(double tau_px) {
    RigOptions out;
    out.client.tau_px = tau_px;
    out.client.mesh_radii = 0;
    out.net = usual();
    out.wrap = [this](Link& inner) {
      auto made = std::make_unique<Gate>(inner);
      gate_ = made.get();
      return made;
    };
    return out;
  }
  Gate* gate_ = nullptr;
  Rig rig_;
  DrawList list_;
};

// More is wanted than can arrive: compares the tiles that arrive.
void goes_on(const Turn& turn, Checks& checks) {
  Walk walk(kTurnTau);
  walk.run(kBeforeS);
  const double before = walk.tiles_a_second(kAfterS);
  walk.worse(turn);
  walk.run(0.5 * turn.seconds);
  const double meanwhile = walk.tiles_a_second(0.5 * turn.seconds);
  walk.as_before(turn);
  walk.run(kAgainS);
  const double after = walk.tiles_a_second(kAfterS);
  // Limits of link and server, and of the asks: one for each object at a time.
  const double link = before * turn.worse.rate_mbps / usual().rate_mbps;
  const double server = 1000 / turn.worse.server_ms;
  const double asks = 1000 * kObjects / (turn.worse.rtt_ms + turn.worse.server_ms);
  if (!turn.silent) {
    checks.at_least(turn.name + ": tiles of those that could come",
                    meanwhile / std::min({link, server, asks}), 0.5);
  }
  checks.at_least(turn.name + ": tiles a second afterwards, of before", after / before, 0.8);
}

// Everything that is wanted can arrive: checks the picture.
void is_well_again(const Turn& turn, Checks& checks) {
  Walk walk(kUsualTau);
  walk.run(kBeforeS);
  walk.worse(turn);
  walk.run(turn.seconds);
  walk.as_before(turn);
  walk.run(kAgainS);
  checks.at_most(turn.name + ": tau afterwards, px", walk.tau_px(), kUsualTau);
  checks.equal(turn.name + ": objects without an image afterwards",
               static_cast<double>(walk.placeholders()), 0);
}

Outcome turning_weather(const Conditions&) {
  std::vector<Turn> turns;
  const auto add = [&](const std::string& name) -> Turn& {
    turns.push_back({name, usual()});
    return turns.back();
  };
  add("20 to 1 Mbit/s").worse.rate_mbps = 1;
  add("RTT 20 to 400 ms").worse.rtt_ms = 400;
  add("jitter of a whole round trip").worse.jitter_ms = usual().rtt_ms;
  add("5 % lost").worse.loss_percent = 5;
  add("server from 2 to 200 ms a tile").worse.server_ms = 200;
  Turn& outage = add("nothing for 5 s");
  outage.silent = true;
  outage.seconds = 5;
  Checks checks;
  for (const Turn& turn : turns) {
    goes_on(turn, checks);
    is_well_again(turn, checks);
  }
  return checks.outcome();
}

}  // namespace

Case turning_weather_case() {
  return {"C5", "link or server worse for a while, then as before",
          "at least half of what it carries is used; well 5 s after it turned back",
          turning_weather};
}

}  // namespace mirage::extreme
