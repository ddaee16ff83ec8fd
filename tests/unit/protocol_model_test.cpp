// The geometry of one object on the wire.
#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <functional>
#include <random>

#include "protocol/limits.h"
#include "protocol/model_codec.h"

namespace mirage::test {
namespace {

ObjectModel small_model() {
  ObjectModel model;
  model.mesh.vertices.resize(3);
  model.mesh.vertices[1].position = {1, 2, 3};
  model.mesh.vertices[2].uv1 = {0.5f, 0.25f};
  model.mesh.vertices[2].color = {1, 2, 3, 4};
  model.mesh.indices = {0, 1, 2};
  model.mesh.primitives = {{PrimitiveKind::kTriangles, 0, 3, 1}, {PrimitiveKind::kLines, 1, 2, 0}};
  model.images.resize(2);
  model.images[0] = {2, 1, true, {1, 2, 3, 4, 5, 6, 7, 8}};
  model.images[1] = {1, 1, false, {9, 10, 11, 12}};
  model.materials.resize(2);
  Material& m = model.materials[1];
  m.base_color = {0.1f, 0.2f, 0.3f, 0.4f};
  m.emissive = {1, 2, 3};
  m.alpha_mode = AlphaMode::kMask;
  m.double_sided = true;
  m.normal_map = {1, 1, Wrap::kClamp, Wrap::kMirror, true, {0.1f, 0.2f}, {3, 4}, 0.5f};
  m.emissive_map.image = 0;
  return model;
}

ErrorId decode_error(const Bytes& bytes) {
  const Result<ObjectModel> model = decode_model(bytes.data(), bytes.size());
  return model ? ErrorId::kInternal : model.error().id;
}

ErrorId error_after(const std::function<void(ObjectModel&)>& change) {
  ObjectModel model = small_model();
  change(model);
  return decode_error(encode_model(model));
}

TEST(ProtocolModel, RoundTrip) {
  const ObjectModel model = small_model();
  const Bytes bytes = encode_model(model);
  EXPECT_EQ(bytes.size(), encoded_model_bytes(model));
  const Result<ObjectModel> back = decode_model(bytes.data(), bytes.size());
  ASSERT_TRUE(back) << back.error().line();
  EXPECT_EQ(std::memcmp(back->mesh.vertices.data(), model.mesh.vertices.data(), 3 * sizeof(Vertex)),
            0);
  EXPECT_EQ(back->mesh.indices, model.mesh.indices);
  ASSERT_EQ(back->mesh.primitives.size(), 2u);
  EXPECT_EQ(back->mesh.primitives[1].kind, PrimitiveKind::kLines);
  EXPECT_EQ(back->mesh.primitives[1].first_index, 1u);
  EXPECT_EQ(back->mesh.primitives[1].index_count, 2u);
  EXPECT_EQ(back->mesh.primitives[0].material, 1u);
  ASSERT_EQ(back->images.size(), 2u);
  EXPECT_EQ(back->images[0].rgba, model.images[0].rgba);
  EXPECT_EQ(back->images[0].width, 2u);
  EXPECT_TRUE(back->images[0].srgb);
  EXPECT_FALSE(back->images[1].srgb);
  ASSERT_EQ(back->materials.size(), 2u);
  const Material& m = back->materials[1];
  EXPECT_EQ(m.base_color, model.materials[1].base_color);
  EXPECT_EQ(m.emissive, glm::vec3(1, 2, 3));
  EXPECT_EQ(m.alpha_mode, AlphaMode::kMask);
  EXPECT_TRUE(m.double_sided);
  EXPECT_FALSE(m.unlit);
  EXPECT_EQ(m.normal_map.image, 1);
  EXPECT_EQ(m.normal_map.uv_set, 1);
  EXPECT_EQ(m.normal_map.wrap_s, Wrap::kClamp);
  EXPECT_EQ(m.normal_map.wrap_t, Wrap::kMirror);
  EXPECT_TRUE(m.normal_map.nearest);
  EXPECT_EQ(m.normal_map.scale, glm::vec2(3, 4));
  EXPECT_EQ(m.normal_map.rotation, 0.5f);
  EXPECT_FALSE(m.base_color_map.present());
  EXPECT_EQ(encode_model(*back), bytes);
}

TEST(ProtocolModel, EmptyModel) {
  const Bytes bytes = encode_model({});
  EXPECT_EQ(bytes, Bytes(21, 0));
  EXPECT_EQ(decode_error(bytes), ErrorId::kInternal);
}

TEST(ProtocolModel, CutAtEveryByte) {
  const Bytes bytes = encode_model(small_model());
  for (std::size_t n = 0; n < bytes.size(); ++n) {
    const ErrorId id =
        decode_error({bytes.begin(), bytes.begin() + static_cast<std::ptrdiff_t>(n)});
    ASSERT_TRUE(id == ErrorId::kWireValue || id == ErrorId::kWireMalformed) << n;
  }
  Bytes longer = bytes;
  longer.push_back(0);
  EXPECT_EQ(decode_error(longer), ErrorId::kWireMalformed);
}

TEST(ProtocolModel, IndicesStayInside) {
  EXPECT_EQ(error_after([](auto& m) { m.mesh.indices[2] = 3; }), ErrorId::kWireValue);
  EXPECT_EQ(error_after([](auto& m) { m.mesh.indices[2] = 0xffffffff; }), ErrorId::kWireValue);
  EXPECT_EQ(error_after([](auto& m) { m.mesh.primitives[1].index_count = 3; }),
            ErrorId::kWireValue);
  EXPECT_EQ(error_after([](auto& m) { m.mesh.primitives[1].first_index = 0xffffffff; }),
            ErrorId::kWireValue);
  EXPECT_EQ(error_after([](auto& m) { m.mesh.primitives[0].material = 2; }), ErrorId::kWireValue);
  EXPECT_EQ(error_after([](auto& m) { m.mesh.primitives[0].kind = PrimitiveKind(3); }),
            ErrorId::kWireValue);
  EXPECT_EQ(error_after([](auto& m) { m.materials[0].emissive_map.image = 2; }),
            ErrorId::kWireValue);
  EXPECT_EQ(error_after([](auto& m) { m.materials[0].emissive_map.image = -2; }),
            ErrorId::kWireValue);
  EXPECT_EQ(error_after([](auto& m) { m.materials[0].normal_map.uv_set = 2; }),
            ErrorId::kWireValue);
  EXPECT_EQ(error_after([](auto& m) { m.materials[0].normal_map.wrap_s = Wrap(3); }),
            ErrorId::kWireValue);
  EXPECT_EQ(error_after([](auto& m) { m.materials[0].alpha_mode = AlphaMode(3); }),
            ErrorId::kWireValue);
}

TEST(ProtocolModel, FloatsAreFinite) {
  for (const float bad : {std::nanf(""), HUGE_VALF, -HUGE_VALF}) {
    for (std::size_t i = 0; i < 14; ++i) {  // position, normal, tangent, uv0, uv1
      const ErrorId id = error_after([&](ObjectModel& m) {
        auto* bytes = reinterpret_cast<std::uint8_t*>(&m.mesh.vertices[1]);
        std::memcpy(bytes + i * sizeof(float), &bad, sizeof(float));
      });
      EXPECT_EQ(id, ErrorId::kWireValue) << "vertex float " << i;
    }
    for (int i = 0; i < 4; ++i) {
      EXPECT_EQ(error_after([&](auto& m) { m.materials[1].base_color[i] = bad; }),
                ErrorId::kWireValue);
    }
    for (int i = 0; i < 3; ++i) {
      EXPECT_EQ(error_after([&](auto& m) { m.materials[1].emissive[i] = bad; }),
                ErrorId::kWireValue);
    }
    for (const auto member : {&Material::metallic, &Material::roughness, &Material::normal_scale,
                              &Material::occlusion_strength, &Material::alpha_cutoff}) {
      EXPECT_EQ(error_after([&](auto& m) { m.materials[1].*member = bad; }), ErrorId::kWireValue);
    }
    for (const auto map :
         {&Material::base_color_map, &Material::metal_rough_map, &Material::normal_map,
          &Material::occlusion_map, &Material::emissive_map}) {
      EXPECT_EQ(error_after([&](auto& m) { (m.materials[1].*map).offset.x = bad; }),
                ErrorId::kWireValue);
      EXPECT_EQ(error_after([&](auto& m) { (m.materials[1].*map).scale.y = bad; }),
                ErrorId::kWireValue);
      EXPECT_EQ(error_after([&](auto& m) { (m.materials[1].*map).rotation = bad; }),
                ErrorId::kWireValue);
    }
  }
  // Large is not infinite.
  EXPECT_EQ(error_after([](auto& m) { m.mesh.vertices[0].position = glm::vec3(2e38f); }),
            ErrorId::kInternal);
}

TEST(ProtocolModel, CountsAreCheckedBeforeAllocating) {
  const Bytes good = encode_model(small_model());
  const auto with_word = [&](std::size_t at, std::uint32_t value) {
    Bytes bytes = good;
    std::memcpy(bytes.data() + at, &value, 4);
    return decode_error(bytes);
  };
  EXPECT_EQ(with_word(0, limits::kMaxMeshVertices + 1), ErrorId::kWireLimit);
  EXPECT_EQ(with_word(4, limits::kMaxMeshIndices + 1), ErrorId::kWireLimit);
  EXPECT_EQ(with_word(8, limits::kMaxMeshPrimitives + 1), ErrorId::kWireLimit);
  EXPECT_EQ(with_word(0, limits::kMaxMeshVertices), ErrorId::kWireValue);
  EXPECT_EQ(with_word(4, limits::kMaxMeshIndices), ErrorId::kWireValue);
  const std::size_t images = 12 + 3 * sizeof(Vertex) + 3 * 4 + 2 * 16;
  EXPECT_EQ(with_word(images, 0xffffffffu), ErrorId::kWireValue);      // image count
  EXPECT_EQ(with_word(images + 4, 0), ErrorId::kWireValue);            // width
  EXPECT_EQ(with_word(images + 4, 0x80000000u), ErrorId::kWireValue);  // width
  const std::size_t materials = images + 4 + 12 + 8 + 12 + 4;
  EXPECT_EQ(with_word(materials, 0xffffffffu), ErrorId::kWireValue);
}

TEST(ProtocolModel, FlippedBitsNeverCrash) {
  const Bytes good = encode_model(small_model());
  for (std::size_t bit = 0; bit < good.size() * 8; ++bit) {
    Bytes damaged = good;
    damaged[bit / 8] ^= static_cast<std::uint8_t>(1u << bit % 8);
    decode_error(damaged);
  }
}

}  // namespace
}  // namespace mirage::test
