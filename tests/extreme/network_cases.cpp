// N1 to N4 and N6: clocks, delay, loss, order, a suspended client; on virtual time. N5 is in
// network_server_case.cpp.

#include <algorithm>
#include <cmath>
#include <map>

#include "client/draw/frame_target.h"
#include "client/frame/planned_frame.h"
#include "protocol/base/quantile.h"
#include "protocol/codec/atlas_planes.h"
#include "tests/extreme/network_links.h"
#include "tests/extreme/network_server_case.h"
#include "tests/extreme/registry.h"
#include "tests/extreme/studio.h"
#include "tests/support/rig.h"

namespace mirage::extreme {
using namespace test;
namespace {

constexpr double kHour = 3600;

Pose walking(double t) {
  return eye_at({3 * std::sin(0.4 * t), 0, 9 - 1.4 * std::min(t, 4.0)}, {0, 0, -12});
}

bool well(const DrawList& list) {
  return list.visible > 0 && list.over_tau == 0 && list.placeholders.empty();
}

struct ClockRun {
  double p99_ms = 0;
  bool well = false;
  std::uint64_t asked = 0;
};

// Ten seconds of walking with a jump of the client's clock in the middle, then standing still.
ClockRun with_clocks(double server_off_s, double client_jump_s) {
  RigOptions options;
  options.net.rtt_ms = 50;
  options.net.server_ms = 5;
  Rig rig(rig_scene({}), options);
  // The host's clock cannot be below zero, so both start late enough.
  rig.server_clock.set_us(std::llround((2 * kHour + server_off_s) * 1e6));
  rig.client_offset_us = std::llround(2 * kHour * 1e6);
  rig.run(5, walking);
  rig.client_offset_us += std::llround(client_jump_s * 1e6);
  rig.run(5, walking);
  const DrawList list = rig.run(5, [](double) { return walking(10.5); });
  return {quantile(rig.frame_ms, 0.99), well(list), rig.session.tiles().asked};
}

// N1
Outcome clocks(const Conditions&) {
  const ClockRun usual = with_clocks(0, 0);
  double slower = 0;
  int unwell = usual.well ? 0 : 1, server_differs = 0;
  double most_asked = 0;
  for (const double off : {kHour, -kHour}) {
    const ClockRun server = with_clocks(off, 0), client = with_clocks(0, off);
    slower = std::max({slower, server.p99_ms - usual.p99_ms, client.p99_ms - usual.p99_ms});
    unwell += (server.well ? 0 : 1) + (client.well ? 0 : 1);
    server_differs += server.asked == usual.asked ? 0 : 1;
    most_asked = std::max(most_asked, static_cast<double>(client.asked));
  }
  Checks checks;
  checks.at_most("frame p99 more by, ms", slower, 1);
  checks.equal("runs that did not end well", unwell, 0);
  checks.equal("sessions that depend on the server's clock", server_differs, 0);
  checks.at_most("asks after a jump, times the usual",
                 most_asked / static_cast<double>(usual.asked), 2);
  return checks.outcome();
}

// N2
Outcome round_trips(const Conditions& conditions) {
  double usual = 0, slower = -1e9;
  int without = 0;
  Checks checks;
  for (const double rtt_ms : {0.0, 10.0, 100.0, 1000.0, 10'000.0}) {
    RigOptions options;
    options.net.rtt_ms = rtt_ms;
    options.net.server_ms = 5;
    options.net.rate_mbps = 20;
    Rig rig(rig_scene({}), options);
    rig.run(conditions.quick ? 10 : 30, walking);
    // The time allows three round trips; connecting takes two.
    const DrawList list = rig.run(5 + 6e-3 * rtt_ms, [](double) { return walking(30); });
    const double p99 = quantile(rig.frame_ms, 0.99);
    if (rtt_ms == 0) {
      usual = p99;
    } else {
      slower = std::max(slower, p99 - usual);
    }
    without += list.visible > 0 && list.placeholders.empty() ? 0 : 1;
  }
  checks.at_most("frame p99 more by, ms", slower, 1);
  checks.equal("round trips at which something in view has no image", without, 0);
  return checks.outcome();
}

// A session that stands still before one object, and its links.
struct OneObject {
  explicit OneObject(const NetModel& net) : rig(rig_scene({1}), options(net)) {}
  RigOptions options(const NetModel& net) {
    RigOptions out;
    out.net = net;
    out.frame_us = 2000;
    out.client.mesh_radii = 0;
    out.wrap = [this](Link& inner) {
      auto made = std::make_unique<Gate>(inner);
      gate = made.get();
      return made;
    };
    return out;
  }
  /// `side` is where the eye is. Sides are so far apart that no held tile serves another.
  Pose pose(int side) const {
    const double angle = 2.4 * side + 0.1;
    const glm::dvec3 there(-2.5 * 4, 0, 0);
    return eye_at(there + glm::dvec3(5 * std::sin(angle), 0, 5 * std::cos(angle)), there);
  }
  void stand(double seconds, int side) {
    rig.run(seconds, [&](double) { return pose(side); });
  }
  /// Waits until the link is up again: that time is the network's, not the session's.
  void until_connected(int side) {
    while (!rig.link.connected()) stand(0.002, side);
  }
  /// Returns the seconds until the picture is well.
  double until_well(int side, double limit_s = 30) {
    const double began = rig.now_s();
    while (rig.now_s() - began < limit_s) {
      const double now = rig.now_s();
      if (well(rig.frame(pose(side)))) return now - began;
    }
    return limit_s;
  }
  /// Returns the seconds that one tile takes, without the round trip.
  double tile_s(const NetModel& net) const {
    return 1e-3 * net.server_ms + static_cast<double>(largest_tile) * 8e-6 / net.rate_mbps;
  }
  Gate* gate = nullptr;
  Rig rig;
  std::size_t largest_tile = 60'000;  ///< bytes of a tile of 256 texels, and some
};

// N3
Outcome loss_and_outage(const Conditions& conditions) {
  Checks checks;
  NetModel net;
  net.rtt_ms = 100;
  net.rate_mbps = 20;
  net.server_ms = 5;
  const double rtt_s = 1e-3 * net.rtt_ms, frame_s = 0.004;
  {
    OneObject one(net);
    one.stand(5, 0);
    one.gate->close();
    one.stand(5, 0);
    one.stand(25, 1);  // asks are sent but lost
    one.gate->open();
    const double took = one.until_well(1);
    checks.at_most("well after 30 s of silence, s", took, 2 * rtt_s + one.tile_s(net) + frame_s);
  }
  // Messages under way are lost with the connection, and nobody waits for them.
  for (const double silence_s : {0.2, 30.0}) {
    OneObject one(net);
    one.stand(5, 0);
    one.gate->close();
    one.stand(0.02, 1);
    one.rig.server_link.disconnect();
    one.gate->lose();
    one.gate->open();
    one.stand(silence_s, 1);
    one.rig.server_link.connect();
    one.until_connected(1);
    const double took = one.until_well(1);
    checks.at_most("well after " + number_text(silence_s) + " s without a connection, s", took,
                   2 * rtt_s + one.tile_s(net) + frame_s);
  }
  for (const double percent : {10.0, 30.0, 50.0}) {
    net.loss_percent = percent;
    OneObject one(net);
    std::vector<double> took;
    const int turns = conditions.quick ? 20 : 100;
    int unwell = 0;
    for (int side = 0; side < turns; ++side) {
      took.push_back(one.until_well(side));
      unwell += took.back() < 30 ? 0 : 1;
      one.stand(0.5, side);
    }
    // A lost message arrives 1.5 round trips later; this is the mean round trip of such a link.
    const double p = percent / 100, mean_s = rtt_s * (1 + 2 * 1.5 * p / (1 - p));
    took.erase(took.begin());  // connecting
    checks.at_most("well with " + number_text(percent) + " % lost, median s", quantile(took, 0.5),
                   2 * mean_s + one.tile_s(net) + frame_s);
    checks.equal("never well", unwell, 0);
  }
  return checks.outcome();
}

// Returns the pictures at the ends of three scenes of standing still.
std::vector<Pixels> pictures(const std::function<std::unique_ptr<Link>(Link&)>& wrap,
                             Checks& checks, std::uint64_t& received) {
  std::vector<Pixels> out;
  Result<gl::EglContext> egl = gl::EglContext::create("auto");
  Result<FrameRenderer> renderer = FrameRenderer::create(1024, 8);
  Result<FrameTarget> target = FrameTarget::create(320, 180, 1);
  if (!egl || !renderer || !target) {
    checks.failed("no graphics");
    return out;
  }
  RigOptions options;
  options.net.rtt_ms = 60;
  options.net.rate_mbps = 20;
  options.net.server_ms = 3;
  options.client.atlas_layers = 8;
  options.wrap = wrap;
  Rig rig(rig_scene({}), options);
  std::map<std::uint64_t, AtlasPlanes> texels;
  rig.on_tile = [&](const TileRecord& t, const AtlasPlanes& p) { texels[t.serial] = p; };
  for (const double angle : {0.0, 2.0, 4.2}) {
    const Pose pose = eye_at({12 * std::sin(angle), 1, 12 * std::cos(angle) - 6}, {0, 0, -6});
    DrawList list = rig.run(8, [&](double) { return pose; });
    if (!well(list)) checks.failed("not well after 8 s");
    if (out.empty() && !renderer->reset(rig.session.scene())) checks.failed("no scene");
    // A tile's place in the atlas depends on when it arrived, and it rounds the filter's weights: a
    // few bytes of a picture differ by 1. So the tiles are compared at places of their own.
    AtlasAllocator places(1024, 8);
    for (DrawnImpostor& d : list.impostors) {
      const auto copy = std::make_shared<TileRecord>(*d.tile);
      copy->slot = *places.allocate(d.tile->slot.w, d.tile->slot.h);
      if (!renderer->upload(*copy, texels[copy->serial])) checks.failed("no room for a tile");
      d.tile = copy;
    }
    renderer->draw(*target, {rig.camera, &rig.session.scene(), list, rig.session.lighting()});
    out.push_back(target->read());
  }
  received = rig.session.tiles().received;
  return out;
}

// N4
Outcome disorder(const Conditions& conditions) {
  Checks checks;
  std::uint64_t in_order = 0, scrambled = 0, more = 0;
  const std::vector<Pixels> expected = pictures(nullptr, checks, in_order);
  int differing = 0, compared = 0;
  for (std::uint64_t seed = 1; seed <= (conditions.quick ? 3u : 10u); ++seed) {
    const auto wrap = [&](Link& inner) {
      return std::make_unique<Scrambler>(inner, conditions.seed + seed);
    };
    const std::vector<Pixels> got = pictures(wrap, checks, scrambled);
    more = std::max(more, scrambled);
    for (std::size_t i = 0; i < got.size() && i < expected.size(); ++i) {
      ++compared;
      differing += got[i] == expected[i] ? 0 : 1;
    }
  }
  checks.equal("pictures that differ", differing, 0);
  checks.at_least("pictures compared", compared, 9);
  checks.at_least("replies for one in order",
                  static_cast<double>(more) / std::max<double>(1, static_cast<double>(in_order)),
                  1.2);
  return checks.outcome();
}

struct Burst {
  double bytes_in_trip = 0;  ///< asked for within the first round trip; sizes as they arrived
  double asks_later = 0;     ///< asks more than five seconds later
  double replies = 0;
  bool well = false;
};

// A client that wakes up after sleeping for `hours`; it stands still, things move.
Burst wake_up(bool connection_lost, double clip_s) {
  RigScene scene;
  scene.clip_s = clip_s;
  RigOptions options;
  options.net.rtt_ms = 100;
  options.net.rate_mbps = 20;
  options.net.server_ms = 2;
  Rig rig(rig_scene(scene), options);
  rig.run(6, walking);
  if (connection_lost) rig.server_link.disconnect();
  rig.clock.set_us(rig.clock.now_us() + std::llround(kHour * 1e6));
  rig.server_clock.set_us(rig.server_clock.now_us() + std::llround(kHour * 1e6));
  if (connection_lost) rig.server_link.connect();
  const std::uint64_t before = rig.session.tiles().received;
  const auto still = [](double) { return walking(6); };
  Burst out;
  std::size_t most = 0;
  for (int i = 0; i < 6; ++i) {  // 100 ms
    rig.frame(still(0));
    most = std::max(most, rig.session.in_flight());
  }
  out.bytes_in_trip = static_cast<double>(most) * 8000;
  DrawList list = rig.run(5, still);
  const std::uint64_t asked = rig.session.tiles().asked;
  out.replies = static_cast<double>(rig.session.tiles().received - before);
  list = rig.run(10, still);
  out.asks_later = static_cast<double>(rig.session.tiles().asked - asked);
  out.well = well(list);
  return out;
}

// N6
Outcome suspend(const Conditions&) {
  double most = 0, later = 0, replies = 0;
  int unwell = 0;
  for (const bool lost : {false, true}) {
    const Burst still = wake_up(lost, 0), moving = wake_up(lost, 2);
    most = std::max({most, still.bytes_in_trip, moving.bytes_in_trip});
    later = std::max(later, still.asks_later);
    replies = std::max({replies, still.replies, moving.replies});
    unwell += still.well ? 0 : 1;
  }
  Checks checks;
  checks.at_most("under way in the first 100 ms, KB", most / 1024, 2 * 256);
  checks.equal("asks more than 5 s later, standing still", later, 0);
  checks.at_most("replies within 5 s, of 24 objects with 256 phases", replies, 24 * 10);
  checks.equal("did not end well", unwell, 0);
  return checks.outcome();
}

}  // namespace

std::vector<Case> network_cases() {
  return {
      {"N1", "the server's clock off by 1 h, the client's jumping by +-1 h",
       "frame p99 +< 1 ms, well again", clocks},
      {"N2", "round trips of 0 to 10 s", "frame p99 +< 1 ms, images come", round_trips},
      {"N3", "loss of up to 50 %, an outage of 30 s", "well in <= 2 RTT + 1 tile", loss_and_outage},
      {"N4", "messages reordered and duplicated, both ways", "bitwise the in-order end", disorder},
      killed_server_case(),
      {"N6", "client suspended for 1 h", "one bounded burst", suspend},
  };
}

}  // namespace mirage::extreme
