// View stage: the view tile as a way to draw an object, and when another view is asked for.
#include <gtest/gtest.h>

#include "client/hold/mesh_cache.h"
#include "client/link/modelled_link.h"
#include "client/session/view_stage.h"
#include "protocol/codec/model_codec.h"
#include "protocol/wire/conversions.h"
#include "protocol/wire/unpack.h"
#include "protocol/wire/view_codec.h"
#include "tests/support/core_scene.h"

namespace mirage::test {
namespace {

/// Returns what a server would send for `n` balls side by side: a column of cells for each.
wire::ViewReplyT reply_for(const Camera& camera, std::uint32_t n, std::uint32_t request,
                           Bytes& payload) {
  ViewTile view;
  view.camera = camera;
  view.near_m = 2;
  view.far_m = 50;
  view.rgba.assign(std::size_t{camera.width} * camera.height * 4, 128);
  for (std::uint32_t i = 0; i < n; ++i) view.instances.push_back(i);
  for (std::uint32_t y = 0; y < view.rows(); ++y) {
    for (std::uint32_t x = 0; x < view.columns(); ++x) {
      view.depth.push_back(view.encode_depth(10));
      view.owners.push_back(static_cast<std::uint16_t>(1 + x % n));
    }
  }
  EncodedView encoded = encode_view(view);
  encoded.reply.request_id = request;
  payload = std::move(encoded.payload);
  return std::move(encoded.reply);
}

Message message_of(const wire::ViewReplyT& reply, const Bytes& payload) {
  Message message;
  message.body.Set(wire::ViewReplyT(reply));
  message.payload = payload;
  message.payload_bytes = payload.size();
  EXPECT_TRUE(MessageUnpacker().unpack(message));
  return message;
}

constexpr std::uint32_t kLight = 1;  // serial

struct CoreView : ::testing::Test {
  /// Balls of radius 1 in a row, seen from 20 m.
  explicit CoreView(std::uint32_t n = 24) {
    std::vector<Placed> balls;
    for (std::uint32_t i = 0; i < n; ++i) {
      balls.push_back({{2.2 * (static_cast<double>(i) - 0.5 * n), 0, -20}});
    }
    scene = make_scene(balls);
    camera.width = 320;
    camera.height = 180;
    camera.pose = look_at({0, 0, 0}, {0, 0, -1});
  }
  DrawList all_missing() const {
    DrawList list;
    for (std::uint32_t i = 0; i < scene.instances.size(); ++i) list.placeholders.push_back({i, 20});
    return list;
  }
  void arrive(std::uint32_t request) {
    Bytes payload;
    const wire::ViewReplyT reply =
        reply_for(camera, static_cast<std::uint32_t>(scene.instances.size()), request, payload);
    const auto taken = stage.take(message_of(reply, payload));
    ASSERT_TRUE(taken);
    ASSERT_TRUE(*taken);
  }
  SceneView scene;
  Camera camera;
  ViewStage stage{true};
};

TEST_F(CoreView, ShowsWhatHasNoImageAndNothingElse) {
  stage.asked(1);
  arrive(1);
  DrawList list = all_missing();
  list.placeholders.erase(list.placeholders.begin() + 3);
  DrawnImpostor own;
  own.instance = 3;
  list.impostors.push_back(own);
  list.placeholders.erase(list.placeholders.begin() + 5);
  list.meshes.push_back({6, 0, 1});
  stage.show_missing(scene, camera, 0, list);
  ASSERT_TRUE(list.view);
  for (std::size_t i = 0; i < scene.instances.size(); ++i) {
    EXPECT_EQ(list.view->owners[i], i != 3 && i != 6) << i;
  }
  for (const DrawnPlaceholder& p : list.placeholders) EXPECT_TRUE(p.covered);
  // Geometry that fades in lies over the view beneath it.
  list.meshes[0].fade = 0.5f;
  stage.show_missing(scene, camera, 0, list);
  EXPECT_TRUE(list.view->owners[6]);
  list.meshes[0].fade = 1;
  list.meshes[0].plain = true;
  stage.show_missing(scene, camera, 0, list);
  EXPECT_TRUE(list.view->owners[6]) << "geometry without its image";
  EXPECT_EQ(stage.counts().drawn, 1u);
}

// The scene arrives in pages: nothing else can show what is on a later one.
TEST_F(CoreView, ShowsWhatIsNotToldOfYet) {
  stage.asked(1);
  arrive(1);
  SceneView early;
  ASSERT_TRUE(early.accept(make_welcome(24, 0, 4, {})).ok());
  ASSERT_TRUE(early.accept(make_objects({})).ok());
  wire::InstancePageT page;
  for (std::uint32_t i = 0; i < 4; ++i) {
    const Placed ball{from_wire(to_wire(scene.instances[i].center))};
    page.instances.push_back(instance_record(ball, i));
  }
  ASSERT_TRUE(early.accept(page).ok());
  ASSERT_TRUE(early.complete());
  DrawList list;
  for (std::uint32_t i = 0; i < 4; ++i) list.meshes.push_back({i, 0, 1});
  stage.show_missing(early, camera, 0, list);
  ASSERT_TRUE(list.view);
  for (std::size_t i = 0; i < 24; ++i) EXPECT_EQ(list.view->owners[i], i >= 4) << i;
  wire::InstancePageT last;
  last.last = true;
  ASSERT_TRUE(early.accept(last).ok());
  list.view.reset();
  stage.show_missing(early, camera, 0, list);
  EXPECT_FALSE(list.view) << "told of all: what is not known is in no view from here";
}

// The eye stands, and all that the view shows is lit by a sun that has moved on.
TEST_F(CoreView, AsksAgainOnceTheLightHasChanged) {
  constexpr std::int64_t kMs = 1'000;
  DrawList list = all_missing();
  std::uint32_t request = 0;
  const auto asks = [&](std::uint32_t light, std::int64_t at_ms) {
    const bool asked = stage.plan(scene, camera, 0, light, list, at_ms * kMs).has_value();
    if (asked) stage.asked(++request);
    return asked;
  };
  ASSERT_TRUE(asks(kLight, 0));
  arrive(request);
  stage.show_missing(scene, camera, 0, list);
  EXPECT_FALSE(asks(kLight, 5'000)) << "it is the light of the view";
  ASSERT_TRUE(asks(2, 5'100));
  arrive(request);
  EXPECT_FALSE(asks(2, 9'000)) << "it has this light";
  ASSERT_TRUE(asks(3, 9'100));
  arrive(request);
  EXPECT_FALSE(asks(4, 9'200)) << "the light moves on";
  EXPECT_FALSE(asks(4, 9'400));
  ASSERT_TRUE(asks(4, 9'500)) << "it has come to rest";
  wire::RefusedT busy;
  busy.request_id = request;
  ASSERT_TRUE(stage.refused(busy, 9'500 * kMs));
  EXPECT_FALSE(asks(4, 10'500)) << "the server is busy";
  ASSERT_TRUE(asks(4, 12'500)) << "the view still has another light";
  arrive(request);
  // A light that never rests gets a view a second.
  const std::uint32_t before = request;
  for (std::uint32_t frame = 0; frame < 100; ++frame) {
    if (asks(5 + frame, 20'000 + frame * 50)) arrive(request);
  }
  EXPECT_EQ(request - before, 5u);
}

TEST_F(CoreView, AsksForNoOtherLightWhereItShowsLittle) {
  stage.asked(1);
  arrive(1);
  DrawList list;
  EXPECT_FALSE(stage.plan(scene, camera, 0, kLight, list, 0));
  EXPECT_FALSE(stage.plan(scene, camera, 0, 2, list, 1));
  EXPECT_FALSE(stage.plan(scene, camera, 0, 2, list, 60'000'000));
}

TEST_F(CoreView, IsNotDrawnOnceAllHaveImages) {
  stage.asked(1);
  arrive(1);
  DrawList list;
  for (std::uint32_t i = 0; i < scene.instances.size(); ++i) list.meshes.push_back({i, 0, 1});
  stage.show_missing(scene, camera, 0, list);
  EXPECT_FALSE(list.view);
  EXPECT_EQ(stage.counts().drawn, 0u);
}

// A second view from one place would not show what the first one does not, because it is hidden or
// too small. Without this rule a viewer that stood still got views for ever and never came to rest.
TEST_F(CoreView, FromOnePlaceOneIsAskedFor) {
  const DrawList list = all_missing();
  ASSERT_TRUE(stage.plan(scene, camera, 0, kLight, list, 1));
  stage.asked(1);
  arrive(1);
  EXPECT_FALSE(stage.plan(scene, camera, 1, kLight, list, 2));
  Camera moved = camera;
  moved.pose.eye.x += 0.01 * scene.bounds_radius;
  EXPECT_TRUE(stage.plan(scene, moved, 1, kLight, list, 3));
  stage.forget();
  EXPECT_TRUE(stage.plan(scene, moved, 1, kLight, list, 4)) << "of another scene";
}

TEST_F(CoreView, AnotherIsAskedForWhereNothingShows) {
  DrawList list = all_missing();
  stage.show_missing(scene, camera, 0, list);
  EXPECT_FALSE(list.view);
  ASSERT_TRUE(stage.plan(scene, camera, 0, kLight, list, 0));
  stage.asked(7);
  EXPECT_FALSE(stage.plan(scene, camera, 0, kLight, list, 0)) << "one at a time";
  arrive(7);
  stage.show_missing(scene, camera, 0, list);
  EXPECT_FALSE(stage.plan(scene, camera, 0, kLight, list, 0)) << "it shows them all";
  camera.pose.eye.x += 12;  // two fifths of the distance: from too far aside
  list.view.reset();
  stage.show_missing(scene, camera, 0, list);
  EXPECT_FALSE(list.view) << "shards of another place";
  EXPECT_FALSE(list.placeholders[0].covered);
  EXPECT_TRUE(stage.plan(scene, camera, 0, kLight, list, 0));
}

TEST_F(CoreView, AFewHaveTilesOfTheirOwnSooner) {
  DrawList list = all_missing();
  list.placeholders.resize(5);
  EXPECT_FALSE(stage.plan(scene, camera, 0, kLight, list, 0));
}

TEST_F(CoreView, RefusalsPauseAndOneEndsIt) {
  const DrawList list = all_missing();
  wire::RefusedT refused;
  refused.request_id = 4;
  refused.reason = wire::RefusalReason::Busy;
  EXPECT_FALSE(stage.refused(refused, 0)) << "of something else";
  stage.asked(4);
  EXPECT_TRUE(stage.refused(refused, 0));
  EXPECT_FALSE(stage.plan(scene, camera, 0, kLight, list, 1'000'000));
  EXPECT_TRUE(stage.plan(scene, camera, 0, kLight, list, 3'000'000));
  stage.asked(5);
  refused.request_id = 5;
  refused.reason = wire::RefusalReason::NoView;
  EXPECT_TRUE(stage.refused(refused, 3'000'000));
  EXPECT_FALSE(stage.plan(scene, camera, 0, kLight, list, 60'000'000));
}

// Leaves enlarged to slabs are worse than the view of the leaves. And a way that replaces a torn
// view has nothing to fade in over.
TEST_F(CoreView, GeometryReplacesItOnceItShowsMore) {
  Bytes payload;
  const wire::ViewReplyT reply = reply_for(camera, 24, 1, payload);
  const ViewFit fit(decode_view(reply, payload).take());
  SceneOptions options;
  options.geometry = true;
  SelectorWorld world(make_scene({{scene.instances[12].center}}, options));
  ObjectDescription& object = world.scene.objects[0];
  object.lods = {{9000, 90'000, 0, 0}, {3000, 30'000, 0, 16}};  // slabs
  MeshCache meshes;
  meshes.reset(world.scene, 1 << 30, 1 << 20);
  world.mesh_ready[0] = true;
  bool torn = false;
  const auto drawn = [&](double aside) {
    world.camera = camera;
    world.camera.pose.eye.x += aside;
    ++world.frame;
    SelectorInput in = world.input();
    in.view = torn ? nullptr : &fit;
    in.meshes = &meshes;
    in.mesh_radii = 100;
    return world.select(in).meshes;
  };
  const auto add = [&](std::uint8_t level) {
    ObjectModel model;
    model.mesh.vertices.resize(3);
    model.mesh.indices = {0, 1, 2};
    meshes.add_mesh(0, level, model, 0);
  };
  add(1);
  EXPECT_EQ(*meshes.level(world.scene, camera, 1, 0), 1u);
  EXPECT_TRUE(drawn(0).empty()) << "the view shows more";
  torn = true;
  ASSERT_EQ(drawn(0.1).size(), 1u) << "but not from here";
  EXPECT_EQ(drawn(0.1)[0].fade, 1) << "and is torn, seen from there";
  torn = false;
  drawn(0);
  world.now_us += 1'000'000;
  EXPECT_TRUE(drawn(0).empty());
  add(0);
  ASSERT_EQ(drawn(0).size(), 1u);
  EXPECT_LT(drawn(0)[0].fade, 1) << "fades in over the view";
}

TEST_F(CoreView, WhatWasNotAskedForIsNotTaken) {
  Bytes payload;
  const wire::ViewReplyT reply = reply_for(camera, 24, 9, payload);
  const auto taken = stage.take(message_of(reply, payload));
  ASSERT_TRUE(taken);
  EXPECT_FALSE(*taken);
  stage.asked(9);
  Message damaged = message_of(reply, payload);
  damaged.payload.pop_back();
  EXPECT_FALSE(stage.take(damaged));
  EXPECT_FALSE(stage.here());
}

TEST_F(CoreView, TheErrorIsATexelAndGrowsAside) {
  Bytes payload;
  const wire::ViewReplyT reply = reply_for(camera, 24, 1, payload);
  const ViewFit fit(decode_view(reply, payload).take());
  const InstanceView& middle = scene.instances[12];
  const ObjectDescription& still = scene.objects[middle.object];
  EXPECT_NEAR(*fit.error_px(middle, still, camera, 0), 1, 1e-6);
  double before = 1;
  for (const double x : {0.5, 1.0, 2.0, 4.0}) {
    Camera aside = camera;
    aside.pose.eye.x += x;
    const double error = *fit.error_px(middle, still, aside, 0);
    EXPECT_GT(error, before);
    before = error;
  }
  Camera little = camera;
  little.pose.eye.x += 1;
  EXPECT_LT(*fit.error_px(middle, still, little, 0, 0.25), *fit.error_px(middle, still, little, 0));
  EXPECT_EQ(*fit.error_px(middle, still, camera, 0, 0.25), *fit.error_px(middle, still, camera, 0));
  Camera far = camera;
  far.pose.eye.x += 10;
  EXPECT_FALSE(fit.error_px(middle, still, far, 0));
  EXPECT_FALSE(fit.error_px(scene.instances[0], still, camera, 0)) << "outside of the view";
}

TEST_F(CoreView, WhatHasMovedSinceIsNotShown) {
  Bytes payload;
  const wire::ViewReplyT reply = reply_for(camera, 24, 1, payload);
  const ViewFit fit(decode_view(reply, payload).take());
  const InstanceView& ball = scene.instances[12];
  ObjectDescription moving = scene.objects[ball.object];
  moving.motion.clip_s = 10;
  moving.motion.speed.assign(limits::kMotionSegments, moving.radius);
  EXPECT_TRUE(fit.shows(ball, moving, camera, 0));
  EXPECT_TRUE(fit.shows(ball, moving, camera, 0.001));
  EXPECT_LT(*fit.error_px(ball, moving, camera, 0), *fit.error_px(ball, moving, camera, 1));
  EXPECT_FALSE(fit.shows(ball, moving, camera, 5));
  moving.motion.hidden.assign(32, 0xff);
  EXPECT_FALSE(fit.shows(ball, moving, camera, 0)) << "it had no extent";
  EXPECT_FALSE(fit.error_px(ball, moving, camera, 0));
}

// Once the eye rests, whatever still lacks a picture gets one, however little it is.
TEST_F(CoreView, AtRestLittleIsEnoughToAsk) {
  DrawList list;
  list.placeholders.push_back({12, 20});
  EXPECT_FALSE(stage.plan(scene, camera, 0, kLight, list, 0));
  EXPECT_FALSE(stage.plan(scene, camera, 0, kLight, list, 900'000));
  EXPECT_TRUE(stage.plan(scene, camera, 0, kLight, list, 1'000'000));
}

/// Answers a hello with a welcome, a page and a view, in this order.
struct ViewServer final : Link {
  void send(Bytes bytes) override {
    Message message = decode_message(bytes.data(), bytes.size()).take();
    if (!message.body.AsHello()) return;
    Message welcome;
    welcome.body.Set(wire::WelcomeT{});
    welcome.body.AsWelcome()->objects = 1;
    replies.push_back(std::move(welcome));
    Message page;
    page.body.Set(wire::ObjectPageT{});
    page.body.AsObjectPage()->objects.push_back(std::make_unique<wire::ObjectInfoT>());
    page.payload.resize(200'000);
    page.payload_bytes = page.payload.size();
    replies.push_back(std::move(page));
    Camera camera;
    camera.width = 64;
    camera.height = 36;
    Message view;
    wire::ViewReplyT reply = reply_for(camera, 2, 3, view.payload);
    view.payload_bytes = view.payload.size();
    reply.kept = kept;  // because of an earlier client: the model must ignore it
    view.body.Set(std::move(reply));
    replies.push_back(std::move(view));
  }
  std::vector<Message> receive() override { return std::exchange(replies, {}); }
  bool connected() const override { return true; }
  std::uint32_t generation() const override { return 1; }
  LinkTraffic traffic() const override { return {}; }
  bool kept = true;
  std::vector<Message> replies;
};

// Returns when the view and the page arrive, ms, over 100 ms and 20 Mbit/s with 5 ms a tile.
std::pair<double, double> arrivals(bool home, bool kept) {
  ViewServer server;
  server.kept = kept;
  VirtualClock clock;
  NetModel net;
  net.rtt_ms = 100;
  net.rate_mbps = 20;
  net.server_ms = 5;
  ModelledLink link(server, clock, net, true, [] { return true; });
  wire::HelloT hello;
  hello.view = std::make_unique<wire::ViewRequestT>(view_request(Camera{}, 0));
  hello.view->request_id = 3;
  hello.view->home = home;
  link.send(encode_message(std::move(hello)));
  std::pair<double, double> out{0, 0};
  for (std::int64_t us = 0; us < 1'000'000; us += 500) {
    clock.advance_to_us(us);
    for (const Message& m : link.receive()) {
      (m.body.AsViewReply()    ? out.first
       : m.body.AsObjectPage() ? out.second
                               : out.second) = static_cast<double>(us) * 1e-3;
    }
  }
  return out;
}

TEST(CoreViewLink, TheHomeViewComesFirstAndAnotherTakesTheTimeOfItsTiles) {
  const auto [home, page] = arrivals(true, false);
  EXPECT_NEAR(home, 101, 3) << "a round trip for the hello";
  EXPECT_GT(page, home + 70) << "200 KB behind it";
  EXPECT_EQ(arrivals(true, true), arrivals(true, false)) << "whoever was there before";
  const auto [drawn, early_page] = arrivals(false, false);
  EXPECT_EQ(arrivals(false, true), arrivals(false, false));
  EXPECT_NEAR(drawn, 101 + 5 * kViewTiles, 90) << "behind what is being transmitted, at most";
  EXPECT_LT(early_page, page + 1) << "nothing waits for it";
}

}  // namespace
}  // namespace mirage::test
