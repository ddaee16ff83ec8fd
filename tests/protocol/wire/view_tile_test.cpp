// View tiles: requests for them, their codes, and what hostile bytes can do.
#include "protocol/impostor/view_tile.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <random>

#include "protocol/wire/view_codec.h"
#include "tests/support/protocol_samples.h"

namespace mirage::test {
namespace {

ViewTile sample_view() {
  ViewTile view;
  view.camera.width = 64;
  view.camera.height = 36;
  view.near_m = 0.5;
  view.far_m = 300;
  view.instances = {4, 9};
  std::mt19937 random(5);
  for (std::size_t i = 0; i < 64u * 36u; ++i) {
    const auto shade = static_cast<std::uint8_t>(i % 64 * 3);
    view.rgba.insert(view.rgba.end(), {shade, 90, 40, 255});
  }
  for (std::size_t i = 0; i < 32u * 18u; ++i) {
    const auto kind = random() % 4;
    view.depth.push_back(kind == 0 ? 0 : static_cast<std::uint8_t>(1 + random() % 255));
    view.owners.push_back(kind == 0   ? std::uint16_t{0}
                          : kind == 3 ? ViewTile::kNobody
                                      : static_cast<std::uint16_t>(kind));
  }
  return view;
}

TEST(ViewTile, WhatIsAskedForIsWhatAnyScreenShowsAndMore) {
  for (const auto& [w, h] : {std::pair{1280u, 720u},
                             {480u, 270u},
                             {3840u, 2160u},
                             {720u, 1280u},
                             {16384u, 1u},
                             {1u, 16384u},
                             {33u, 17u}}) {
    Camera screen;
    screen.width = w;
    screen.height = h;
    const wire::ViewRequestT request = view_request(screen, 0);
    const Bytes bytes = encode_message(wire::ViewRequestT(request));
    EXPECT_TRUE(decode_message(bytes.data(), bytes.size())) << w << "x" << h;
    EXPECT_GT(request.fov_y, screen.fov_y);
  }
  const wire::ViewRequestT usual = view_request(Camera{}, 0);
  EXPECT_EQ(usual.width, 640);
  EXPECT_EQ(usual.height, 360);
  Camera wide;
  wide.fov_y = limits::kMaxFovDegrees * 3.14159265358979 / 180;
  EXPECT_LE(view_request(wide, 0).fov_y * 180 / 3.14159265358979, limits::kMaxFovDegrees + 1e-9);
}

TEST(ViewTile, WhoStandsTogetherSharesOne) {
  wire::ViewRequestT a = view_request(Camera{}, 0);
  const auto id = [](const wire::ViewRequestT& m) { return view_id(1, 2, view_pose(m)); };
  wire::ViewRequestT b = view_request(Camera{}, 0);
  *b.eye = wire::Vec3d(0.0001, 0, 0);
  *b.rotation = wire::Quat(-1, 0, 0.0001f, 0);
  EXPECT_TRUE(id(a) == id(b)) << "the same turn has two signs";
  *b.eye = wire::Vec3d(0.01, 0, 0);
  EXPECT_FALSE(id(a) == id(b));
  EXPECT_FALSE(view_id(1, 2, view_pose(a)) == view_id(2, 2, view_pose(a)));
  EXPECT_FALSE(view_id(1, 2, view_pose(a)) == view_id(1, 3, view_pose(a)));
}

TEST(ViewTile, DepthIsNeverBehindAndNeverNearerThanAStep) {
  ViewTile view;
  view.near_m = 0.3;
  view.far_m = 900;
  for (double z = view.near_m; z <= view.far_m; z *= 1.003) {
    const double drawn = view.decode_depth(view.encode_depth(z));
    EXPECT_LE(drawn, z * (1 + 1e-12));
    EXPECT_GE(drawn, z * (1 - view.depth_step()) * (1 - 1e-12));
  }
  view.far_m = view.near_m;
  EXPECT_DOUBLE_EQ(view.decode_depth(view.encode_depth(0.3)), 0.3) << "one depth only";
}

TEST(ViewTile, PlanesSurviveAndColoursNearly) {
  const ViewTile view = sample_view();
  EncodedView encoded = encode_view(view);
  const Bytes bytes = encode_message(std::move(encoded.reply), encoded.payload);
  const Message message = decode_message(bytes.data(), bytes.size()).take();
  const Result<ViewTile> again = decode_view(*message.body.AsViewReply(), message.payload);
  ASSERT_TRUE(again);
  EXPECT_EQ(again->depth, view.depth);
  EXPECT_EQ(again->owners, view.owners);
  EXPECT_EQ(again->instances, view.instances);
  EXPECT_EQ(again->near_m, view.near_m);
  EXPECT_EQ(again->camera.width, 64u);
  ASSERT_EQ(again->rgba.size(), view.rgba.size());
  double sum = 0;
  for (std::size_t i = 0; i < view.rgba.size(); ++i) {
    sum += std::abs(int{view.rgba[i]} - int{again->rgba[i]});
  }
  EXPECT_LT(sum / static_cast<double>(view.rgba.size()), 3);
}

TEST(ViewTile, HostileRepliesAreErrors) {
  const ViewTile view = sample_view();
  const EncodedView good = encode_view(view);
  const auto fails = [&](const auto& change) {
    wire::ViewReplyT reply = good.reply;
    Bytes payload = good.payload;
    change(reply, payload);
    return !decode_view(reply, payload);
  };
  EXPECT_TRUE(fails([](wire::ViewReplyT&, Bytes& p) { p.resize(p.size() / 2); }));
  EXPECT_TRUE(fails([](wire::ViewReplyT&, Bytes& p) { p.clear(); }));
  EXPECT_TRUE(fails([](wire::ViewReplyT& r, Bytes&) { r.color_bytes = 1u << 31; }));
  EXPECT_TRUE(fails([](wire::ViewReplyT& r, Bytes&) { r.color_bytes -= 7; }));
  EXPECT_TRUE(fails([](wire::ViewReplyT& r, Bytes&) { r.instances = {4}; })) << "owner 2 is gone";
  EXPECT_TRUE(fails([](wire::ViewReplyT& r, Bytes&) { r.instances = {9, 4}; }));
  EXPECT_TRUE(fails([](wire::ViewReplyT& r, Bytes&) { r.width = 128; }));
  std::mt19937 random(3);
  for (int i = 0; i < 2000; ++i) {
    wire::ViewReplyT reply = good.reply;
    Bytes payload = good.payload;
    for (int n = 0; n < 4; ++n)
      payload[random() % payload.size()] = static_cast<std::uint8_t>(random());
    const Result<ViewTile> view_of = decode_view(reply, payload);
    if (!view_of) continue;
    EXPECT_EQ(view_of->owners.size(), 32u * 18u);
  }
}

TEST(ViewTile, RequestsOutsideTheLimitsAreRefusedByTheWire) {
  const auto refused = [](const auto& change) {
    wire::ViewRequestT m = sample_view_request();
    change(m);
    const Bytes alone = encode_message(wire::ViewRequestT(m));
    wire::HelloT hello = sample_hello();
    hello.view = std::make_unique<wire::ViewRequestT>(m);
    const Bytes greeting = encode_message(std::move(hello));
    return !decode_message(alone.data(), alone.size()) &&
           !decode_message(greeting.data(), greeting.size());
  };
  constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
  EXPECT_FALSE(refused([](wire::ViewRequestT&) {}));
  EXPECT_TRUE(refused([](wire::ViewRequestT& m) { m.width = 0; }));
  EXPECT_TRUE(refused([](wire::ViewRequestT& m) { m.height = 0; }));
  EXPECT_TRUE(refused([](wire::ViewRequestT& m) { m.width = m.height = 16384; }));
  EXPECT_TRUE(refused([](wire::ViewRequestT& m) { m.width = m.height = 1024; }));
  EXPECT_TRUE(refused([](wire::ViewRequestT& m) { m.width = 65; })) << "cells have two texels";
  EXPECT_TRUE(refused([](wire::ViewRequestT& m) { *m.eye = wire::Vec3d(kNan, 0, 0); }));
  EXPECT_TRUE(refused([](wire::ViewRequestT& m) { *m.rotation = wire::Quat(0, 0, 0, 0); }));
  EXPECT_TRUE(refused([](wire::ViewRequestT& m) { m.fov_y = kNan; }));
  EXPECT_TRUE(refused([](wire::ViewRequestT& m) { m.fov_y = 3.2; }));
  EXPECT_TRUE(refused([](wire::ViewRequestT& m) { m.time_s = kNan; }));
}

}  // namespace
}  // namespace mirage::test
