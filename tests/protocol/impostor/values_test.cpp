// Values that a message may not hold: floats that are not finite, missing parts, values out of
// range.
#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <optional>

#include "protocol/impostor/tile.h"
#include "protocol/model/scene_types.h"
#include "protocol/wire/conversions.h"
#include "protocol/wire/message.h"
#include "tests/support/protocol_samples.h"

namespace mirage::test {
namespace {

/// Does with a message what the programs do: decodes it, then converts its content to their own
/// types.
Result<Message> received(const Bytes& bytes) {
  Result<Message> message = decode_message(bytes.data(), bytes.size());
  if (!message) return message;
  const auto lighting_checked = [&](const wire::LightingT* lighting) -> Result<Message> {
    if (Result<Lighting> l = from_wire(*lighting); !l) return l.error();
    return std::move(message);
  };
  if (const auto* m = message->body.AsWelcome()) return lighting_checked(m->lighting.get());
  if (const auto* m = message->body.AsSetLighting()) return lighting_checked(m->lighting.get());
  if (const auto* m = message->body.AsTileReply()) {
    if (Result<Tile> tile = tile_from_fields(*m); !tile) return tile.error();
  }
  return message;
}

template <typename BodyT>
void expect_refused(const BodyT& body, ErrorId id, const char* what) {
  const Result<Message> message = received(encode_message(BodyT(body)));
  ASSERT_FALSE(message) << what;
  EXPECT_EQ(message.error().id, id) << what << ": " << message.error().line();
}

TEST(ProtocolValues, SamplesAreAccepted) {
  for (const Bytes& bytes : sample_messages()) {
    const Result<Message> message = received(bytes);
    EXPECT_TRUE(message) << message.error().line();
  }
}

/// Expects a refusal for NaN and for either infinity where `change` puts them.
template <typename BodyT, typename Change>
void expect_finite_only(const BodyT& body, const Change& change, const char* what) {
  for (const double bad : {std::nan(""), HUGE_VAL, -HUGE_VAL}) {
    BodyT damaged(body);
    change(damaged, bad);
    expect_refused(damaged, ErrorId::kWireValue, what);
  }
}

/// Writes into the bytes of a wire struct, which has no setters; its bytes are its layout.
template <typename ScalarT, typename StructT>
void poke(StructT& s, std::size_t index, double value) {
  const auto scalar = static_cast<ScalarT>(value);
  ASSERT_LE((index + 1) * sizeof(ScalarT), sizeof(StructT));
  std::memcpy(reinterpret_cast<std::uint8_t*>(&s) + index * sizeof(ScalarT), &scalar,
              sizeof(ScalarT));
}
void set_nth(wire::Vec3f& v, std::size_t i, double value) { poke<float>(v, i, value); }
void set_nth(wire::Vec3d& v, std::size_t i, double value) { poke<double>(v, i, value); }
void set_nth(wire::Quat& q, std::size_t i, double value) { poke<float>(q, i, value); }

wire::Light damaged_light(int field, float v) {
  wire::Light l = sample_lighting()->lights[0];
  const wire::Vec3d position(field == 0 ? double(v) : 1, field == 1 ? double(v) : 2,
                             field == 2 ? double(v) : 3);
  const wire::Vec3f color(field == 3 ? v : 4, field == 4 ? v : 5, field == 5 ? v : 6);
  const wire::Vec3f direction(field == 6 ? v : 0, field == 7 ? v : -1, field == 8 ? v : 0);
  return {position,
          color,
          direction,
          field == 9 ? v : 7,
          field == 10 ? v : 0.8f,
          field == 11 ? v : 0.7f,
          l.kind()};
}

TEST(ProtocolValues, FogIsADensity) {
  const auto damage = [](auto& m, double v) { m.fog_density = static_cast<float>(v); };
  expect_finite_only(sample_welcome(), damage, "environment");
  wire::WelcomeT negative = sample_welcome();
  negative.fog_density = -1e-6f;
  expect_refused(negative, ErrorId::kWireValue, "environment");
}

TEST(ProtocolValues, NoFloatOfALightingMayBeNotFinite) {
  for (std::size_t i = 0; i < 3; ++i) {
    expect_finite_only(
        sample_set_lighting(), [i](auto& m, double v) { set_nth(*m.lighting->ambient, i, v); },
        "ambient");
    expect_finite_only(
        sample_welcome(), [i](auto& m, double v) { set_nth(*m.lighting->ambient, i, v); },
        "ambient");
  }
  for (int field = 0; field < 12; ++field) {
    const auto damage = [field](auto& m, double v) {
      m.lighting->lights[0] = damaged_light(field, static_cast<float>(v));
    };
    expect_finite_only(sample_set_lighting(), damage, "light");
    expect_finite_only(sample_welcome(), damage, "light");
  }
}

TEST(ProtocolValues, NoFloatOfAWelcomeMayBeNotFinite) {
  const wire::WelcomeT good = sample_welcome();
  for (std::size_t i = 0; i < 3; ++i) {
    expect_finite_only(
        good, [i](auto& m, double v) { set_nth(*m.sky_zenith, i, v); }, "zenith");
    expect_finite_only(
        good, [i](auto& m, double v) { set_nth(*m.sky_horizon, i, v); }, "horizon");
    expect_finite_only(
        good, [i](auto& m, double v) { set_nth(*m.sky_nadir, i, v); }, "nadir");
    expect_finite_only(
        good, [i](auto& m, double v) { set_nth(*m.home_eye, i, v); }, "eye");
    expect_finite_only(
        good, [i](auto& m, double v) { set_nth(*m.home_target, i, v); }, "target");
  }
  expect_finite_only(
      good, [](auto& m, double v) { m.walk_radius_m = v; }, "walk radius");
  expect_finite_only(
      good, [](auto& m, double v) { m.walk_speed_mps = v; }, "walk speed");
}

TEST(ProtocolValues, NoFloatOfAnObjectMayBeNotFinite) {
  const wire::ObjectPageT good = sample_object_page();
  for (std::size_t i = 0; i < 3; ++i) {
    const auto of = [&](auto member, const char* what) {
      expect_finite_only(
          good, [&](auto& m, double v) { set_nth(*((*m.objects[1]).*member), i, v); }, what);
    };
    of(&wire::ObjectInfoT::center, "center");
    of(&wire::ObjectInfoT::box_min, "box_min");
    of(&wire::ObjectInfoT::box_max, "box_max");
    of(&wire::ObjectInfoT::mean_color, "mean_color");
    expect_finite_only(
        good, [i](auto& m, double v) { set_nth(m.objects[1]->hull_vertices[3], i, v); },
        "hull vertex");
  }
  expect_finite_only(
      good, [](auto& m, double v) { m.objects[1]->hull_parallax[2] = float(v); }, "parallax");
  expect_finite_only(
      good, [](auto& m, double v) { m.objects[1]->radius = float(v); }, "radius");
}

TEST(ProtocolValues, OpacityOfAnObjectIsAShare) {
  const auto decoded = [](float opacity) {
    wire::ObjectPageT page = sample_object_page();
    page.objects[1]->opacity = opacity;
    const Bytes bytes = encode_message(std::move(page));
    return decode_message(bytes.data(), bytes.size()).ok();
  };
  for (const float share : {0.0f, 0.25f, 1.0f}) EXPECT_TRUE(decoded(share)) << share;
  for (const float wrong : {-0.01f, 1.01f, NAN}) EXPECT_FALSE(decoded(wrong)) << wrong;
}

TEST(ProtocolValues, FacesOfAnObjectAreWholeOrAbsent) {
  const auto decoded = [](float sine, std::optional<wire::Vec3f> axis) {
    wire::ObjectPageT page = sample_object_page();
    page.objects[1]->faces_sine = sine;
    if (axis) page.objects[1]->faces_axis = std::make_unique<wire::Vec3f>(*axis);
    const Bytes bytes = encode_message(std::move(page));
    return decode_message(bytes.data(), bytes.size()).ok();
  };
  const wire::Vec3f up(0, 1, 0);
  EXPECT_TRUE(decoded(1, std::nullopt));
  EXPECT_TRUE(decoded(0, up));
  EXPECT_TRUE(decoded(0.5f, up));
  EXPECT_FALSE(decoded(0.5f, std::nullopt));
  EXPECT_FALSE(decoded(0.5f, wire::Vec3f(NAN, 1, 0)));
  for (const float wrong : {-0.1f, 1.1f, NAN}) EXPECT_FALSE(decoded(wrong, up)) << wrong;
}

TEST(ProtocolValues, MotionOfAnObjectIsWholeOrAbsent) {
  const auto decoded = [](auto change) {
    wire::ObjectPageT page = sample_object_page();
    change(*page.objects[1]);
    const Bytes bytes = encode_message(std::move(page));
    return decode_message(bytes.data(), bytes.size()).ok();
  };
  const auto moving = [](wire::ObjectInfoT& o) {
    o.clip_s = 2;
    o.speed.assign(limits::kMotionSegments, 1.0f);
    o.jump.assign(256, 0.5f);
    o.wrap_jump = 0.25f;
    o.track_clip_s = 2;
    o.track.assign(limits::kTrackSteps + 1, wire::Vec3f(1, 2, 3));
  };
  const auto still = [](wire::ObjectInfoT& o) {
    o.clip_s = o.wrap_jump = o.track_clip_s = 0;
    o.hidden.clear();
    o.track.clear();
    o.speed.clear();
    o.jump.clear();
  };
  EXPECT_TRUE(decoded(still));
  EXPECT_TRUE(decoded(moving));
  const auto broken = [&](auto change) {
    return !decoded([&](wire::ObjectInfoT& o) {
      moving(o);
      change(o);
    });
  };
  const float nan = std::numeric_limits<float>::quiet_NaN();
  EXPECT_FALSE(broken([](wire::ObjectInfoT& o) { o.jump.clear(); }));
  EXPECT_TRUE(broken([](wire::ObjectInfoT& o) { o.clip_s = 0; }));
  EXPECT_TRUE(broken([&](wire::ObjectInfoT& o) { o.clip_s = nan; }));
  EXPECT_TRUE(broken([](wire::ObjectInfoT& o) { o.clip_s = 2e6f; }));
  EXPECT_TRUE(broken([](wire::ObjectInfoT& o) { o.speed.pop_back(); }));
  EXPECT_TRUE(broken([](wire::ObjectInfoT& o) { o.jump.push_back(0); }));
  EXPECT_TRUE(broken([&](wire::ObjectInfoT& o) { o.speed[3] = nan; }));
  EXPECT_TRUE(broken([](wire::ObjectInfoT& o) { o.jump[3] = -1; }));
  EXPECT_TRUE(broken([&](wire::ObjectInfoT& o) { o.wrap_jump = nan; }));
  EXPECT_FALSE(broken([](wire::ObjectInfoT& o) { o.hidden.assign(32, 0xf0); }));
  EXPECT_TRUE(broken([](wire::ObjectInfoT& o) { o.hidden.assign(31, 0xf0); }));
  EXPECT_TRUE(broken([&](wire::ObjectInfoT& o) { still(o), o.hidden.assign(32, 0); }));
  EXPECT_FALSE(broken([](wire::ObjectInfoT& o) { o.track_clip_s = 0, o.track.clear(); }));
  EXPECT_TRUE(broken([](wire::ObjectInfoT& o) { o.track.pop_back(); }));
  EXPECT_TRUE(broken([](wire::ObjectInfoT& o) { o.track.clear(); }));
  EXPECT_TRUE(broken([](wire::ObjectInfoT& o) { o.track_clip_s = 0; }));
  EXPECT_TRUE(broken([&](wire::ObjectInfoT& o) { o.track_clip_s = nan; }));
  EXPECT_TRUE(broken([&](wire::ObjectInfoT& o) { o.track[7] = wire::Vec3f(0, nan, 0); }));
}

TEST(ProtocolValues, NoFloatOfAnInstanceMayBeNotFinite) {
  const auto instance = [](int field, double v) {
    const auto f = static_cast<float>(v);
    return wire::InstanceRecord(
        wire::Vec3d(field == 0 ? v : 1, field == 1 ? v : 2, field == 2 ? v : 3),
        wire::Quat(field == 3 ? f : 1, field == 4 ? f : 0, field == 5 ? f : 0, field == 6 ? f : 0),
        field == 7 ? f : 1, 0, 0, 0, field == 8 ? f : 0, 1);
  };
  for (int field = 0; field < 9; ++field) {
    expect_finite_only(
        sample_instance_page(), [&](auto& m, double v) { m.instances[1] = instance(field, v); },
        "instance");
  }
  for (const double scale : {0.0, -1.0}) {
    wire::InstancePageT page = sample_instance_page();
    page.instances[0] = instance(7, scale);
    expect_refused(page, ErrorId::kWireValue, "scale");
  }
  wire::InstancePageT page = sample_instance_page();
  page.instances[0] = instance(3, 2.0);
  expect_refused(page, ErrorId::kWireValue, "rotation that is not unit");
  page = sample_instance_page();
  page.instances[0] = wire::InstanceRecord({}, wire::Quat(1, 0, 0, 0), 1, 0, 0, 0, 0, 3);
  expect_refused(page, ErrorId::kWireValue, "importance that does not exist");
}

TEST(ProtocolValues, NoFloatOfAGroupOrOfWhoAsksForOneMayBeNotFinite) {
  for (std::size_t i = 0; i < 3; ++i) {
    expect_finite_only(
        sample_instance_page(),
        [i](auto& m, double v) {
          wire::Vec3d center(1, 2, 3);
          set_nth(center, i, v);
          m.groups[0] = wire::GroupRecord(center, wire::Vec3f(1, 1, 1), 0, 0, 8, 9, 0, 1, 1);
        },
        "centre");
    expect_finite_only(
        sample_instance_page(),
        [i](auto& m, double v) {
          wire::Vec3f half(1, 2, 3);
          set_nth(half, i, v);
          m.groups[0] = wire::GroupRecord(wire::Vec3d(1, 1, 1), half, 0, 0, 8, 9, 0, 1, 1);
        },
        "half");
    expect_finite_only(
        sample_open_request(), [i](auto& m, double v) { set_nth(*m.eye, i, v); }, "eye");
    expect_finite_only(
        sample_open_request(), [i](auto& m, double v) { set_nth(*m.forward, i, v); }, "forward");
  }
  wire::InstancePageT page = sample_instance_page();
  page.groups[0] =
      wire::GroupRecord(wire::Vec3d(1, 1, 1), wire::Vec3f(1, -1, 1), 0, 0, 8, 9, 0, 1, 1);
  expect_refused(page, ErrorId::kWireValue, "half below 0");
  const auto damaged = [](auto damage) {
    wire::OpenRequestT request = sample_open_request();
    damage(request);
    return request;
  };
  expect_finite_only(
      sample_open_request(), [](auto& m, double v) { m.focal_px = v; }, "focal");
  expect_finite_only(
      sample_open_request(), [](auto& m, double v) { m.tau_px = v; }, "tau");
  expect_finite_only(
      sample_open_request(), [](auto& m, double v) { m.speed_mps = v; }, "speed");
  expect_finite_only(
      sample_open_request(), [](auto& m, double v) { m.margin = v; }, "margin");
  expect_refused(damaged([](auto& m) { m.tau_px = 0; }), ErrorId::kWireValue, "tau of 0");
  expect_refused(damaged([](auto& m) { m.margin = 100; }), ErrorId::kWireValue, "margin");
  expect_refused(damaged([](auto& m) { m.speed_mps = -1; }), ErrorId::kWireValue, "speed");
  expect_refused(damaged([](auto& m) { m.groups.resize(limits::kMaxOpensPerRequest + 1); }),
                 ErrorId::kWireLimit, "groups in a request");
}

TEST(ProtocolValues, NoFloatOfARequestMayBeNotFinite) {
  expect_finite_only(
      sample_request_batch(), [](auto& m, double v) { poke<float>(m.asks[1], 3, v); }, "error_px");
  const wire::ReferenceRequestT good = sample_reference_request();
  for (std::size_t i = 0; i < 3; ++i) {
    expect_finite_only(
        good, [i](auto& m, double v) { set_nth(*m.eye, i, v); }, "eye");
    expect_finite_only(
        good, [i](auto& m, double v) { set_nth(*m.rotation, i, v); }, "rotation");
  }
  expect_finite_only(
      good, [](auto& m, double v) { set_nth(*m.rotation, 3, v); }, "rotation");
  expect_finite_only(
      good, [](auto& m, double v) { m.fov_y = v; }, "fov_y");
}

TEST(ProtocolValues, NoFloatOfATileMayBeNotFinite) {
  const wire::TileReplyT good = sample_tile_reply();
  const auto of = [&](float wire::TileReplyT::*member) {
    expect_finite_only(
        good, [&](auto& m, double v) { m.*member = float(v); }, "tile measure");
  };
  for (const auto member :
       {&wire::TileReplyT::plane_depth, &wire::TileReplyT::depth_min, &wire::TileReplyT::depth_max,
        &wire::TileReplyT::dz_quad, &wire::TileReplyT::dz_cuboid, &wire::TileReplyT::dz_hull,
        &wire::TileReplyT::depth_gap, &wire::TileReplyT::dz_behind, &wire::TileReplyT::lod_error,
        &wire::TileReplyT::color_rms}) {
    of(member);
  }
}

TEST(ProtocolValues, MissingPartsAreRefused) {
  wire::SetLightingT no_lighting;
  const Bytes bytes = encode_message(std::move(no_lighting));
  const Result<Message> message = decode_message(bytes.data(), bytes.size());
  ASSERT_FALSE(message);
  EXPECT_EQ(message.error().id, ErrorId::kWireValue);
  wire::WelcomeT welcome = sample_welcome();
  welcome.home_eye.reset();
  expect_refused(welcome, ErrorId::kWireValue, "home eye");
  wire::ReferenceRequestT request = sample_reference_request();
  request.rotation.reset();
  expect_refused(request, ErrorId::kWireValue, "rotation");
}

TEST(ProtocolValues, ReferenceRequestsHaveARange) {
  const auto refused = [](const auto& change) {
    wire::ReferenceRequestT m = sample_reference_request();
    change(m);
    expect_refused(m, ErrorId::kWireValue, "reference request");
  };
  refused([](auto& m) { m.width = 0; });
  refused([](auto& m) { m.height = 0; });
  refused([](auto& m) { m.width = limits::kMaxReferenceEdge + 1; });
  refused([](auto& m) { m.height = 0xffffffffu; });
  refused([](auto& m) { m.supersample = 0; });
  refused([](auto& m) { m.shift_x = 9.0 * m.width; });
  refused([](auto& m) { m.shift_y = std::nan(""); });
  refused([](auto& m) { m.pixel_aspect = 0; });
  refused([](auto& m) { m.pixel_aspect = std::nan(""); });
  refused([](auto& m) { m.supersample = limits::kMaxReferenceSupersample + 1; });
  for (const double degrees : {0.0, 0.009, -60.0, 170.1, 179.0, 180.0}) {
    refused([degrees](auto& m) { m.fov_y = degrees / 57.29577951308232; });
  }
}

}  // namespace
}  // namespace mirage::test
