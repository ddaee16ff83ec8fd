// The geometry of one level on the wire.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <functional>

#include "protocol/base/limits.h"
#include "protocol/codec/material_codec.h"
#include "protocol/codec/model_codec.h"

namespace mirage::test {
namespace {

constexpr std::size_t kImages = 2;
constexpr std::size_t kHeaderBytes = 9 * 4 + 6 * 4 + 4 * 4 + 4 * 4;
constexpr std::size_t kPrimitiveBytes = 12;

/// Returns a bumpy sheet of n x n quads with every stream in use.
ObjectModel sheet(std::uint32_t n) {
  ObjectModel model;
  for (std::uint32_t y = 0; y <= n; ++y) {
    for (std::uint32_t x = 0; x <= n; ++x) {
      const glm::vec2 at = glm::vec2(x, y) / static_cast<float>(n);
      Vertex v;
      v.position = {3 * at.x, 0.2f * std::sin(9 * at.x) * std::cos(7 * at.y), 5 * at.y - 2};
      v.normal = glm::normalize(glm::vec3(std::sin(5 * at.x), 1 - 2 * at.y, std::cos(4 * at.y)));
      v.tangent = glm::vec4(glm::normalize(glm::vec3(1, at.x, at.y - 0.5f)), x % 2 ? 1.0f : -1.0f);
      v.uv0 = 8.0f * at - 2.0f;
      v.uv1 = at;
      v.color = {x * 65535 / n, y * 65535 / n, 300, 65535};
      model.mesh.vertices.push_back(v);
    }
  }
  for (std::uint32_t y = 0; y < n; ++y) {
    for (std::uint32_t x = 0; x < n; ++x) {
      const std::uint32_t a = y * (n + 1) + x;
      for (const std::uint32_t i : {a, a + 1, a + n + 2, a, a + n + 2, a + n + 1}) {
        model.mesh.indices.push_back(i);
      }
    }
  }
  const auto half = static_cast<std::uint32_t>(model.mesh.indices.size() / 2 / 3 * 3);
  const auto rest = static_cast<std::uint32_t>(model.mesh.indices.size()) - half;
  for (const std::uint32_t i : {0u, n, n, 2 * n}) model.mesh.indices.push_back(i);
  model.mesh.primitives = {{PrimitiveKind::kTriangles, 0, half, 1},
                           {PrimitiveKind::kTriangles, half, rest, 0},
                           {PrimitiveKind::kLines, half + rest, 4, 0}};
  model.materials.resize(2);
  Material& m = model.materials[1];
  m.base_color = {0.1f, 0.2f, 0.3f, 0.4f};
  m.emissive = {1, 2, 3};
  m.alpha_mode = AlphaMode::kBlend;  // keeps its triangles' order
  m.double_sided = true;
  m.base_color_map.image = 0;
  m.normal_map = {1, 1, Wrap::kClamp, Wrap::kMirror, true, {0.1f, 0.2f}, {3, 4}, 0.5f};
  model.materials[0].emissive_map.image = 1;
  model.materials[0].lobes.anisotropy = 0.5f;
  model.materials[0].lobes.map(LobeMap::kAnisotropy).image = 1;
  return model;
}

Result<ObjectModel> decode(const Bytes& bytes) {
  return decode_model(bytes.data(), bytes.size(), kImages);
}

ErrorId decode_error(const Bytes& bytes) {
  const Result<ObjectModel> model = decode(bytes);
  return model ? ErrorId::kInternal : model.error().id;
}

bool refused(const Bytes& bytes) {
  const ErrorId id = decode_error(bytes);
  return id == ErrorId::kWireValue || id == ErrorId::kWireMalformed || id == ErrorId::kWireLimit;
}

TEST(ProtocolModel, RoundTripWithinTheStatedError) {
  const ObjectModel model = sheet(40);
  const Result<ObjectModel> back = decode(encode_model(model));
  ASSERT_TRUE(back) << back.error().line();
  glm::vec3 low(INFINITY), high(-INFINITY);
  for (const Vertex& v : model.mesh.vertices) {
    low = glm::min(low, v.position);
    high = glm::max(high, v.position);
  }
  const double step = quantisation_error(low, high);
  EXPECT_LT(step, 1e-4);
  ASSERT_EQ(back->mesh.indices.size(), model.mesh.indices.size());
  ASSERT_EQ(back->mesh.primitives.size(), 3u);
  // The blended primitive keeps its order, so compare it corner by corner.
  const Primitive& p = back->mesh.primitives[0];
  ASSERT_EQ(p.material, 1u);
  for (std::uint32_t t = 0; t < p.index_count; t += 3) {
    // The index codec may rotate the corners of a triangle.
    const auto corner = [&](std::uint32_t k) -> const Vertex& {
      return back->mesh.vertices[back->mesh.indices[p.first_index + t + k % 3]];
    };
    const auto original = [&](std::uint32_t k) -> const Vertex& {
      return model.mesh.vertices[model.mesh.indices[t + k]];
    };
    std::uint32_t turn = 0;
    for (std::uint32_t k = 1; k < 3; ++k) {
      if (glm::length(corner(k).position - original(0).position) <
          glm::length(corner(turn).position - original(0).position)) {
        turn = k;
      }
    }
    for (std::uint32_t k = 0; k < 3; ++k) {
      const Vertex &a = original(k), &b = corner(turn + k);
      ASSERT_LE(double{glm::length(a.position - b.position)}, step);
      ASSERT_GT(glm::dot(a.normal, b.normal), std::cos(0.004f));
      ASSERT_GT(glm::dot(glm::vec3(a.tangent), glm::vec3(b.tangent)), std::cos(0.004f));
      ASSERT_EQ(a.tangent.w, b.tangent.w);
      ASSERT_LE(glm::length(a.uv0 - b.uv0), 8.0f / 65535);
      ASSERT_LE(glm::length(a.uv1 - b.uv1), 1.0f / 65535);
      for (int c = 0; c < 4; ++c) {
        const double x = std::sqrt(a.color[c] / 65535.0), y = std::sqrt(b.color[c] / 65535.0);
        ASSERT_NEAR(x, y, 0.51 / 255) << c;
      }
    }
  }
  const Primitive& lines = back->mesh.primitives[2];
  EXPECT_EQ(lines.kind, PrimitiveKind::kLines);
  ASSERT_EQ(lines.index_count, 4u);
  EXPECT_LE(double{glm::length(back->mesh.vertices[back->mesh.indices[lines.first_index]].position -
                               model.mesh.vertices[0].position)},
            step);
  EXPECT_EQ(encode_materials(back->materials), encode_materials(model.materials));
}

TEST(ProtocolModel, StreamsTravelOnlyWhenNeeded) {
  ObjectModel plain = sheet(60);
  const std::size_t all = encode_model(plain).size();
  for (Material& m : plain.materials) m.base_color_map.image = m.normal_map.image = -1;
  plain.materials[0].emissive_map.image = -1;
  plain.materials[0].lobes = {};
  for (Vertex& v : plain.mesh.vertices) v.color = glm::u16vec4(65535);
  const Bytes bytes = encode_model(plain);
  EXPECT_LT(bytes.size(), 0.75 * static_cast<double>(all));
  const Result<ObjectModel> back = decode(bytes);
  ASSERT_TRUE(back);
  for (const Vertex& v : back->mesh.vertices) {
    EXPECT_EQ(v.uv0, glm::vec2(0));
    EXPECT_EQ(v.color, glm::u16vec4(65535));
  }
  EXPECT_LT(bytes.size(), std::size_t{61} * 61 * sizeof(Vertex) / 5);
}

TEST(ProtocolModel, UnusedAndDoubledVerticesAreLeftOut) {
  ObjectModel model = sheet(4);
  const std::size_t before = decode(encode_model(model))->mesh.vertices.size();
  const std::vector<Vertex> vertices = model.mesh.vertices;
  model.mesh.vertices.insert(model.mesh.vertices.end(), vertices.begin(), vertices.end());
  for (std::size_t i = 0; i < model.mesh.indices.size(); i += 2) {
    model.mesh.indices[i] += static_cast<std::uint32_t>(vertices.size());
  }
  model.mesh.vertices.resize(model.mesh.vertices.size() + 100);
  EXPECT_EQ(decode(encode_model(model))->mesh.vertices.size(), before);
}

TEST(ProtocolModel, EmptyModel) {
  const Bytes bytes = encode_model({});
  EXPECT_EQ(bytes.size(), kHeaderBytes + 1) << "and no animation";
  EXPECT_TRUE(decode(bytes));
}

TEST(ProtocolModel, CutAtEveryByte) {
  const Bytes bytes = encode_model(sheet(3));
  for (std::size_t n = 0; n < bytes.size(); ++n) {
    ASSERT_TRUE(refused({bytes.begin(), bytes.begin() + static_cast<std::ptrdiff_t>(n)})) << n;
  }
  Bytes longer = bytes;
  longer.push_back(0);
  EXPECT_EQ(decode_error(longer), ErrorId::kWireMalformed);
}

template <typename T>
Bytes with(Bytes bytes, std::size_t at, T value) {
  std::memcpy(bytes.data() + at, &value, sizeof(T));
  return bytes;
}

TEST(ProtocolModel, CountsAreCheckedBeforeAllocating) {
  const Bytes good = encode_model(sheet(3));
  ASSERT_EQ(decode_error(good), ErrorId::kInternal);
  const auto word = [&](std::size_t index, std::uint32_t value) {
    return decode_error(with(good, index * 4, value));
  };
  EXPECT_EQ(word(0, limits::kMaxMeshVertices + 1), ErrorId::kWireLimit);
  EXPECT_EQ(word(1, limits::kMaxMeshIndices + 1), ErrorId::kWireLimit);
  EXPECT_EQ(word(2, limits::kMaxMeshIndices + 1), ErrorId::kWireLimit);
  EXPECT_EQ(word(3, limits::kMaxMeshPrimitives + 1), ErrorId::kWireLimit);
  EXPECT_EQ(word(4, limits::kMaxMeshPrimitives + 1), ErrorId::kWireLimit);
  EXPECT_EQ(word(0, limits::kMaxMeshVertices), ErrorId::kWireValue) << "not in so few bytes";
  EXPECT_EQ(word(1, limits::kMaxMeshIndices / 3 * 3 - 30), ErrorId::kWireValue);
  EXPECT_EQ(word(2, limits::kMaxMeshIndices / 2), ErrorId::kWireValue);
  for (const std::size_t bytes : {5u, 6u, 7u}) {
    EXPECT_EQ(word(bytes, 0xffffffffu), ErrorId::kWireMalformed);
  }
  EXPECT_EQ(word(8, 16), ErrorId::kWireValue) << "unknown stream";
  EXPECT_TRUE(refused(with(good, 4, std::uint32_t{17}))) << "not whole triangles";
}

TEST(ProtocolModel, RangesAreFinite) {
  const Bytes good = encode_model(sheet(3));
  for (const float bad : {std::nanf(""), HUGE_VALF, -HUGE_VALF}) {
    for (std::size_t i = 0; i < 14; ++i) {
      EXPECT_EQ(decode_error(with(good, 36 + 4 * i, bad)), ErrorId::kWireValue) << i;
    }
  }
  EXPECT_EQ(decode_error(with(good, 36 + 12, -1.0f)), ErrorId::kWireValue) << "negative size";
  EXPECT_EQ(decode_error(with(good, 36, 2e38f)), ErrorId::kInternal) << "large is not infinite";
}

TEST(ProtocolModel, PrimitivesStayInTheirPart) {
  const ObjectModel model = sheet(3);
  const Bytes good = encode_model(model);
  const auto primitive = [&](std::size_t index, std::size_t word, std::uint32_t value) {
    return decode_error(with(good, kHeaderBytes + index * kPrimitiveBytes + word * 4, value));
  };
  EXPECT_EQ(primitive(0, 0, 3), ErrorId::kWireValue) << "kind";
  EXPECT_EQ(primitive(0, 0, 1), ErrorId::kWireValue) << "lines among the triangles";
  EXPECT_EQ(primitive(2, 0, 0), ErrorId::kWireValue) << "triangles among the lines";
  EXPECT_EQ(primitive(1, 1, 0xffffffffu), ErrorId::kWireValue) << "count";
  EXPECT_EQ(primitive(2, 1, 3), ErrorId::kWireValue) << "does not add up";
  EXPECT_EQ(primitive(0, 2, 2), ErrorId::kWireValue) << "material";
}

TEST(ProtocolModel, MaterialsAreChecked) {
  const auto error_after = [](const std::function<void(Material&)>& change) {
    ObjectModel model = sheet(2);
    change(model.materials[1]);
    return decode_error(encode_model(model));
  };
  EXPECT_EQ(error_after([](Material& m) { m.emissive_map.image = kImages; }), ErrorId::kWireValue);
  EXPECT_EQ(error_after([](Material& m) { m.emissive_map.image = -2; }), ErrorId::kWireValue);
  EXPECT_EQ(error_after([](Material& m) { m.normal_map.uv_set = 2; }), ErrorId::kWireValue);
  EXPECT_EQ(error_after([](Material& m) { m.normal_map.wrap_s = Wrap(3); }), ErrorId::kWireValue);
  EXPECT_EQ(error_after([](Material& m) { m.alpha_mode = AlphaMode(3); }), ErrorId::kWireValue);
  for (const float bad : {std::nanf(""), HUGE_VALF, -HUGE_VALF}) {
    for (int i = 0; i < 4; ++i) {
      EXPECT_EQ(error_after([&](auto& m) { m.base_color[i] = bad; }), ErrorId::kWireValue);
    }
    for (int i = 0; i < 3; ++i) {
      EXPECT_EQ(error_after([&](auto& m) { m.emissive[i] = bad; }), ErrorId::kWireValue);
    }
    for (const auto member : {&Material::metallic, &Material::roughness, &Material::normal_scale,
                              &Material::occlusion_strength, &Material::alpha_cutoff}) {
      EXPECT_EQ(error_after([&](auto& m) { m.*member = bad; }), ErrorId::kWireValue);
    }
    for (const auto map :
         {&Material::base_color_map, &Material::metal_rough_map, &Material::normal_map,
          &Material::occlusion_map, &Material::emissive_map}) {
      EXPECT_EQ(error_after([&](auto& m) { (m.*map).offset.x = bad; }), ErrorId::kWireValue);
      EXPECT_EQ(error_after([&](auto& m) { (m.*map).scale.y = bad; }), ErrorId::kWireValue);
      EXPECT_EQ(error_after([&](auto& m) { (m.*map).rotation = bad; }), ErrorId::kWireValue);
    }
  }
}

TEST(ProtocolModel, LobesComeBackAndCostNothingWhereThereAreNone) {
  ByteWriter plain;
  put_material(plain, Material());
  EXPECT_EQ(plain.bytes.size(), kMaterialBytes);
  Material m;
  m.lobes.specular_color = {0.5f, 2, 1};
  m.lobes.ior = 1.33f;
  m.lobes.clearcoat = 0.75f;
  m.lobes.sheen_color = {0.1f, 0.2f, 0.3f};
  m.lobes.transmission = 0.5f;
  m.lobes.volume_tint = {0.9f, 0.8f, 0.7f};
  m.lobes.map(LobeMap::kTransmission).image = 2;
  m.lobes.map(LobeMap::kTransmission).uv_set = 1;
  ByteWriter w;
  put_material(w, m);
  const Bytes bytes = w.bytes;
  ByteReader r(bytes.data(), bytes.size());
  Material back;
  ASSERT_TRUE(get_material(r, back, 3));
  EXPECT_EQ(back.lobes.specular_color, m.lobes.specular_color);
  EXPECT_EQ(back.lobes.ior, 1.33f);
  EXPECT_EQ(back.lobes.clearcoat, 0.75f);
  EXPECT_EQ(back.lobes.sheen_color, m.lobes.sheen_color);
  EXPECT_EQ(back.lobes.volume_tint, m.lobes.volume_tint);
  EXPECT_EQ(back.lobes.map(LobeMap::kTransmission).image, 2);
  EXPECT_EQ(back.lobes.map(LobeMap::kTransmission).uv_set, 1);
  ByteReader few(bytes.data(), bytes.size());
  EXPECT_FALSE(get_material(few, back, 2)) << "an image that is not there";
  for (std::size_t n = kMaterialBytes; n < bytes.size(); n += 7) {
    ByteReader cut(bytes.data(), n);
    EXPECT_FALSE(get_material(cut, back, 3)) << n;
  }
  for (const auto& [what, spoil] : std::initializer_list<std::pair<const char*, void (*)(Lobes&)>>{
           {"NaN", [](Lobes& l) { l.clearcoat = std::nanf(""); }},
           {"negative", [](Lobes& l) { l.sheen_color.g = -1; }},
           {"index below 1", [](Lobes& l) { l.ior = 0.5f; }}}) {
    Material bad = m;
    spoil(bad.lobes);
    ByteWriter out;
    put_material(out, bad);
    const Bytes spoilt = out.bytes;
    ByteReader in(spoilt.data(), spoilt.size());
    EXPECT_FALSE(get_material(in, back, 3)) << what;
  }
}

TEST(ProtocolModel, AnisotropyFollowsLobesThatAreWhatTheyWere) {
  const auto bytes_of = [](const Material& m) {
    ByteWriter w;
    put_material(w, m);
    return w.bytes;
  };
  const auto taken = [](const Bytes& bytes, Material& m, std::size_t images) {
    ByteReader r(bytes.data(), bytes.size());
    return get_material(r, m, images) && r.left() == 0;
  };
  constexpr std::size_t kFlags = kMaterialBytes - 5 * kTextureBytes - 1;
  constexpr std::size_t kLobes = 15 * 4 + 7 * kTextureBytes, kGrain = 2 * 4 + kTextureBytes;
  for (const bool others : {false, true}) {
    Material m;
    if (others) m.lobes.clearcoat = 0.75f;
    const Bytes without = bytes_of(m);
    const std::size_t size = kMaterialBytes + (others ? kLobes : 0);
    ASSERT_EQ(without.size(), size);
    m.lobes.anisotropy = 0.5f;
    m.lobes.anisotropy_rotation = 1.25f;
    m.lobes.map(LobeMap::kAnisotropy).image = 2;
    m.lobes.map(LobeMap::kAnisotropy).uv_set = 1;
    const Bytes bytes = bytes_of(m);
    ASSERT_EQ(bytes.size(), size + kGrain);
    Bytes first(bytes.begin(), bytes.begin() + static_cast<std::ptrdiff_t>(size));
    EXPECT_EQ(first[kFlags], others ? 3 : 2);
    first[kFlags] = without[kFlags];
    EXPECT_EQ(first, without);
    Material back;
    ASSERT_TRUE(taken(bytes, back, 3));
    EXPECT_EQ(back.lobes.anisotropy, 0.5f);
    EXPECT_EQ(back.lobes.anisotropy_rotation, 1.25f);
    EXPECT_EQ(back.lobes.map(LobeMap::kAnisotropy).image, 2);
    EXPECT_EQ(back.lobes.map(LobeMap::kAnisotropy).uv_set, 1);
    EXPECT_EQ(back.lobes.clearcoat, m.lobes.clearcoat);
    EXPECT_FALSE(taken(bytes, back, 2)) << "an image that is not there";
    for (std::size_t n = kMaterialBytes; n < bytes.size(); ++n) {
      const Bytes cut(bytes.begin(), bytes.begin() + static_cast<std::ptrdiff_t>(n));
      EXPECT_FALSE(taken(cut, back, 3)) << n;
    }
    for (const unsigned flags : {4u, 7u, 255u}) {
      Bytes unknown = bytes;
      unknown[kFlags] = static_cast<std::uint8_t>(flags);
      EXPECT_FALSE(taken(unknown, back, 3)) << flags;
    }
    for (const float bad : {std::nanf(""), HUGE_VALF, -HUGE_VALF, -0.01f, 3.2f}) {
      Material spoilt = m;
      spoilt.lobes.anisotropy = bad;
      EXPECT_FALSE(taken(bytes_of(spoilt), back, 3)) << bad;
      spoilt = m;
      spoilt.lobes.anisotropy_rotation = bad;
      EXPECT_FALSE(taken(bytes_of(spoilt), back, 3)) << bad;
    }
    m.lobes.anisotropy = 1.01f;
    EXPECT_FALSE(taken(bytes_of(m), back, 3));
  }
}

// The texture coordinates of its map and the tangents are sent as well.
TEST(ProtocolModel, AnisotropyTravelsWithItsTangents) {
  ObjectModel plain = sheet(6);
  plain.materials.assign(2, Material());
  const auto tangent = [](const ObjectModel& model) {
    const Result<ObjectModel> back = decode(encode_model(model));
    EXPECT_TRUE(back);
    return glm::vec3(back->mesh.vertices[8].tangent);
  };
  EXPECT_EQ(tangent(plain), glm::vec3(Vertex().tangent));
  plain.materials[0].lobes.anisotropy = 0.5f;
  EXPECT_NE(tangent(plain), glm::vec3(Vertex().tangent));
}

TEST(ProtocolModel, FlippedBitsNeverCrash) {
  const Bytes good = encode_model(sheet(5));
  for (std::size_t bit = 0; bit < good.size() * 8; ++bit) {
    Bytes damaged = good;
    damaged[bit / 8] ^= static_cast<std::uint8_t>(1u << bit % 8);
    const Result<ObjectModel> model = decode(damaged);
    if (!model) continue;
    for (const std::uint32_t i : model->mesh.indices) ASSERT_LT(i, model->mesh.vertices.size());
    for (const Vertex& v : model->mesh.vertices) {
      ASSERT_TRUE(std::isfinite(v.position.x + v.normal.x + v.uv0.x));
    }
  }
}

}  // namespace
}  // namespace mirage::test
