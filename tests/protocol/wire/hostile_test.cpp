// Hostile messages: limits, versions, amplification, cuts and flips.
#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "protocol/wire/message.h"
#include "tests/support/protocol_samples.h"

namespace mirage::test {
namespace {

/// Returns the error of decoding; kInternal means "accepted".
ErrorId decode_error(const Bytes& bytes) {
  const Result<Message> message = decode_message(bytes.data(), bytes.size());
  return message ? ErrorId::kInternal : message.error().id;
}

Bytes framed(const flatbuffers::FlatBufferBuilder& builder) {
  PacketHeader header;
  header.control_bytes = builder.GetSize();
  Bytes out(kWireHeaderBytes + builder.GetSize());
  write_packet_header(header, out.data());
  std::copy_n(builder.GetBufferPointer(), builder.GetSize(), out.begin() + kWireHeaderBytes);
  return out;
}

TEST(ProtocolHostile, CountsAreHeldAgainstTheLimits) {
  const auto batch = [](std::size_t asks, std::size_t cancels, std::size_t meshes,
                        std::size_t images = 0) {
    wire::RequestBatchT m;
    m.asks.resize(asks);
    m.cancels.resize(cancels);
    m.mesh_asks.resize(meshes);
    m.image_asks.resize(images);
    return decode_error(encode_message(std::move(m)));
  };
  using namespace limits;
  EXPECT_EQ(batch(kMaxAsksPerBatch, kMaxCancelsPerBatch, kMaxAsksPerBatch, kMaxAsksPerBatch),
            ErrorId::kInternal);
  EXPECT_EQ(batch(kMaxAsksPerBatch + 1, 0, 0), ErrorId::kWireLimit);
  EXPECT_EQ(batch(0, kMaxCancelsPerBatch + 1, 0), ErrorId::kWireLimit);
  EXPECT_EQ(batch(0, 0, kMaxAsksPerBatch + 1), ErrorId::kWireLimit);
  EXPECT_EQ(batch(0, 0, 0, kMaxAsksPerBatch + 1), ErrorId::kWireLimit);

  wire::ImagePageT images = sample_image_page();
  images.images.resize(kImagesPerPage, images.images[0]);
  EXPECT_EQ(decode_error(encode_message(wire::ImagePageT(images))), ErrorId::kInternal);
  images.images.push_back(images.images[0]);
  EXPECT_EQ(decode_error(encode_message(std::move(images))), ErrorId::kWireLimit);
  for (const wire::ImageInfo& bad :
       {wire::ImageInfo(0, 4, 0, 0, true), wire::ImageInfo(4, 0, 0, 0, true),
        wire::ImageInfo(kMaxImageEdge + 1, 4, 0, 0, true), wire::ImageInfo(4, 4, 0, -1, true),
        wire::ImageInfo(4, 4, 0, std::nanf(""), true)}) {
    wire::ImagePageT one;
    one.images = {bad};
    EXPECT_EQ(decode_error(encode_message(std::move(one))), ErrorId::kWireValue);
  }

  wire::SetLightingT lighting = sample_set_lighting();
  lighting.lighting->lights.resize(kMaxLights + 1);
  EXPECT_EQ(decode_error(encode_message(std::move(lighting))), ErrorId::kWireLimit);

  wire::InstancePageT page = sample_instance_page();
  page.instances.resize(kInstancesPerPage + 1, page.instances[0]);
  EXPECT_EQ(decode_error(encode_message(wire::InstancePageT(page))), ErrorId::kWireLimit);
  page.groups.resize(kInstancesPerPage, page.groups[0]);
  page.opened.resize(kInstancesPerPage, page.opened[0]);
  page.instances.resize(kInstancesPerPage, page.instances[0]);
  EXPECT_EQ(decode_error(encode_message(std::move(page))), ErrorId::kInternal);
}

TEST(ProtocolHostile, ObjectsAreHeldAgainstTheLimits) {
  const auto page = [](const auto& change) {
    wire::ObjectPageT m = sample_object_page();
    change(m);
    return decode_error(encode_message(std::move(m)));
  };
  using namespace limits;
  EXPECT_EQ(page([](auto& m) {
              while (m.objects.size() < kObjectsPerPage) m.objects.push_back(sample_object());
            }),
            ErrorId::kInternal);
  EXPECT_EQ(page([](auto& m) {
              while (m.objects.size() <= kObjectsPerPage) m.objects.push_back(sample_object());
            }),
            ErrorId::kWireLimit);
  EXPECT_EQ(page([](auto& m) { m.objects[0]->hull_vertices.resize(kMaxHullVertices + 1); }),
            ErrorId::kWireLimit);
  EXPECT_EQ(page([](auto& m) { m.objects[0]->hull_indices.resize(kMaxHullTriangles * 3 + 3); }),
            ErrorId::kWireLimit);
  EXPECT_EQ(page([](auto& m) { m.objects[0]->hull_indices.pop_back(); }), ErrorId::kWireLimit);
  EXPECT_EQ(page([](auto& m) { m.objects[0]->hull_indices[5] = 4; }), ErrorId::kWireValue);
  EXPECT_EQ(page([](auto& m) { m.objects[0]->hull_parallax.pop_back(); }), ErrorId::kWireLimit);
  EXPECT_EQ(page([](auto& m) { m.objects[0]->hull_parallax[1] = -1; }), ErrorId::kWireValue);
  EXPECT_EQ(page([](auto& m) { m.objects[1]->radius = -1; }), ErrorId::kWireValue);
  EXPECT_EQ(page([](auto& m) { m.objects[1]->lods.resize(kMaxLods); }), ErrorId::kInternal);
  EXPECT_EQ(page([](auto& m) { m.objects[1]->lods.resize(kMaxLods + 1); }), ErrorId::kWireLimit);
  for (const float bad : {std::nanf(""), HUGE_VALF, -1.0f}) {
    EXPECT_EQ(page([&](auto& m) { m.objects[1]->lods = {wire::LodInfo(1, 1, bad, 0, 0)}; }),
              ErrorId::kWireValue);
    EXPECT_EQ(page([&](auto& m) { m.objects[1]->lods = {wire::LodInfo(1, 1, 0, 0, bad)}; }),
              ErrorId::kWireValue);
    EXPECT_EQ(page([&](auto& m) { m.objects[1]->lods = {wire::LodInfo(1, 1, 0, bad, 0)}; }),
              ErrorId::kWireValue);
  }
}

TEST(ProtocolHostile, TextsAndTotalsAreHeldAgainstTheLimits) {
  const std::string fits(limits::kMaxTextBytes, 'x'), long_text = fits + "x";
  wire::HelloT hello = sample_hello();
  hello.token = fits;
  EXPECT_EQ(decode_error(encode_message(wire::HelloT(hello))), ErrorId::kInternal);
  hello.token = long_text;
  EXPECT_EQ(decode_error(encode_message(wire::HelloT(hello))), ErrorId::kWireLimit);
  hello.token.clear();
  hello.codecs.resize(33);
  EXPECT_EQ(decode_error(encode_message(wire::HelloT(hello))), ErrorId::kWireLimit);
  hello.codecs.clear();
  hello.clip = std::string(limits::kMaxChoiceBytes, 'x');
  EXPECT_EQ(decode_error(encode_message(wire::HelloT(hello))), ErrorId::kInternal);
  hello.clip += "x";
  EXPECT_EQ(decode_error(encode_message(wire::HelloT(hello))), ErrorId::kWireLimit);
  wire::WelcomeT choices = sample_welcome();
  choices.variants.resize(limits::kMaxChoices);
  EXPECT_EQ(decode_error(encode_message(wire::WelcomeT(choices))), ErrorId::kInternal);
  choices.variants.emplace_back();
  EXPECT_EQ(decode_error(encode_message(wire::WelcomeT(choices))), ErrorId::kWireLimit);
  choices.variants = {hello.clip};
  EXPECT_EQ(decode_error(encode_message(wire::WelcomeT(choices))), ErrorId::kWireLimit);
  wire::WelcomeT look = sample_welcome();
  look.tone = 2;
  EXPECT_EQ(decode_error(encode_message(wire::WelcomeT(look))), ErrorId::kWireValue);
  look.tone = 1;
  look.home_fit.resize(limits::kMaxFitPoints + 1);
  EXPECT_EQ(decode_error(encode_message(wire::WelcomeT(look))), ErrorId::kWireLimit);
  look.home_fit.resize(limits::kMaxFitPoints);
  look.floor = std::make_unique<wire::StudioFloorT>();
  look.floor->center = std::make_unique<wire::Vec3d>(1, 2, 3);
  look.floor->color = std::make_unique<wire::Vec3f>(1, 1, 1);
  look.floor->half = 1;
  look.floor->shadow.resize(4096);
  EXPECT_EQ(decode_error(encode_message(wire::WelcomeT(look))), ErrorId::kInternal);
  for (const float half : {0.0f, -1.0f, std::nanf("")}) {
    look.floor->half = half;
    EXPECT_EQ(decode_error(encode_message(wire::WelcomeT(look))), ErrorId::kWireValue);
  }
  look.floor->half = 1;
  look.floor->shadow.resize(4095);
  EXPECT_EQ(decode_error(encode_message(wire::WelcomeT(look))), ErrorId::kWireValue);
  wire::ByeT bye;
  bye.text = long_text;
  EXPECT_EQ(decode_error(encode_message(std::move(bye))), ErrorId::kWireLimit);
  wire::WelcomeT welcome = sample_welcome();
  welcome.renderer = long_text;
  EXPECT_EQ(decode_error(encode_message(wire::WelcomeT(welcome))), ErrorId::kWireLimit);
  welcome.renderer.clear();
  welcome.objects = limits::kMaxObjects + 1;
  EXPECT_EQ(decode_error(encode_message(wire::WelcomeT(welcome))), ErrorId::kWireLimit);
  welcome.objects = 1;
  welcome.images = limits::kMaxImages + 1;
  EXPECT_EQ(decode_error(encode_message(wire::WelcomeT(welcome))), ErrorId::kWireLimit);
  welcome.images = 1;
  welcome.instances = limits::kMaxInstances + 1;
  EXPECT_EQ(decode_error(encode_message(wire::WelcomeT(welcome))), ErrorId::kWireLimit);
}

TEST(ProtocolHostile, OtherVersionsAndKindsAreNamed) {
  Bytes bytes = encode_message(sample_hello());
  bytes[2] = limits::kProtocolVersion + 1;
  EXPECT_EQ(decode_error(bytes), ErrorId::kWireVersion);
  bytes[2] = limits::kProtocolVersion;
  bytes[3] = 2;  // a chunk is no message
  EXPECT_EQ(decode_error(bytes), ErrorId::kWireMalformed);
  Bytes empty(kWireHeaderBytes);
  write_packet_header({}, empty.data());
  EXPECT_EQ(decode_error(empty), ErrorId::kWireMalformed);
}

TEST(ProtocolHostile, LargeControlPartIsRefused) {
  Bytes bytes(kWireHeaderBytes + limits::kMaxControlBytes + 1);
  PacketHeader header;
  header.control_bytes = limits::kMaxControlBytes + 1;
  write_packet_header(header, bytes.data());
  EXPECT_EQ(decode_error(bytes), ErrorId::kWireLimit);
}

// The verifier accepts a union whose tag is set and whose table is absent.
TEST(ProtocolHostile, TagWithoutBody) {
  for (int tag = 0; tag <= static_cast<int>(wire::Body::MAX) + 1; ++tag) {
    flatbuffers::FlatBufferBuilder builder;
    wire::ControlBuilder control(builder);
    control.add_body_type(static_cast<wire::Body>(tag));
    builder.Finish(control.Finish());
    EXPECT_EQ(decode_error(framed(builder)), ErrorId::kWireMalformed) << tag;
  }
}

TEST(ProtocolHostile, UnknownBodyIsRefused) {
  flatbuffers::FlatBufferBuilder builder;
  const auto bye = wire::CreateBye(builder);
  builder.Finish(wire::CreateControl(builder, static_cast<wire::Body>(200), bye.Union()));
  EXPECT_EQ(decode_error(framed(builder)), ErrorId::kWireMalformed);
}

// Many entries of a vector may point to one table, and many tables to one vector: 100 KB would
// unpack to gigabytes.
TEST(ProtocolHostile, AmplificationIsBounded) {
  const auto page = [](std::size_t objects, std::size_t vertices) {
    flatbuffers::FlatBufferBuilder builder;
    const std::vector<wire::Vec3f> points(vertices, wire::Vec3f(1, 2, 3));
    const auto hull = builder.CreateVectorOfStructs(points);
    const auto parallax = builder.CreateVector(std::vector<float>(vertices, 1.0f));
    const wire::Vec3f v(1, 2, 3);
    wire::ObjectInfoBuilder info(builder);
    info.add_center(&v);
    info.add_radius(1);
    info.add_box_min(&v);
    info.add_box_max(&v);
    info.add_mean_color(&v);
    info.add_hull_vertices(hull);
    info.add_hull_parallax(parallax);
    const auto object = info.Finish();
    const std::vector<flatbuffers::Offset<wire::ObjectInfo>> same(objects, object);
    const auto list = builder.CreateVector(same);
    const auto body = wire::CreateObjectPage(builder, 0, list);
    builder.Finish(wire::CreateControl(builder, wire::Body::ObjectPage, body.Union()));
    return decode_error(framed(builder));
  };
  EXPECT_EQ(page(limits::kObjectsPerPage, limits::kMaxHullVertices), ErrorId::kInternal);
  EXPECT_EQ(page(limits::kObjectsPerPage + 1, 1), ErrorId::kWireLimit);
  EXPECT_EQ(page(1, 10'000), ErrorId::kWireLimit);
  EXPECT_EQ(page(4000, 10'000), ErrorId::kWireLimit);
  EXPECT_EQ(page(20'000, 1'000), ErrorId::kWireMalformed);  // more tables than the verifier accepts
}

TEST(ProtocolHostile, CutAtEveryByte) {
  for (const Bytes& whole : sample_messages()) {
    for (std::size_t n = 0; n < whole.size(); ++n) {
      const Bytes cut(whole.begin(), whole.begin() + static_cast<std::ptrdiff_t>(n));
      ASSERT_EQ(decode_error(cut), ErrorId::kWireMalformed);
      if (n <= kWireHeaderBytes) continue;
      // A header that matches the remaining bytes: the control part ends early.
      Bytes honest = cut;
      PacketHeader header;
      header.control_bytes = static_cast<std::uint32_t>(n - kWireHeaderBytes);
      write_packet_header(header, honest.data());
      decode_error(honest);
    }
  }
}

TEST(ProtocolHostile, FlippedBitsNeverCrash) {
  std::mt19937 random(8);
  for (const Bytes& whole : sample_messages()) {
    for (std::size_t bit = 0; bit < whole.size() * 8; ++bit) {
      Bytes damaged = whole;
      damaged[bit / 8] ^= static_cast<std::uint8_t>(1u << bit % 8);
      decode_error(damaged);
    }
    for (int i = 0; i < 1000; ++i) {
      Bytes damaged = whole;
      for (int k = 0; k < 4; ++k) {
        const std::size_t at = kWireHeaderBytes + random() % (damaged.size() - kWireHeaderBytes);
        damaged[at] = static_cast<std::uint8_t>(random());
      }
      decode_error(damaged);
    }
  }
}

}  // namespace
}  // namespace mirage::test
