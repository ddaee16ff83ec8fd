// Compressed geometry: KHR_draco_mesh_compression, EXT_meshopt_compression.
#ifdef MIRAGE_DRACO
#include <draco/compression/encode.h>
#include <draco/mesh/triangle_soup_mesh_builder.h>
#endif
#include <dlfcn.h>
#include <meshoptimizer.h>

#include <cmath>

#include "server/scene/gltf/draco_decode.h"
#include "server/scene/gltf/gltf_limits.h"
#include "server/scene/gltf/meshopt_decode.h"
#include "tests/support/gltf_fixture.h"

namespace mirage::test {
namespace {

using gltf::decode_draco;
using gltf::decode_meshopt;
using gltf::DracoAttribute;
using gltf::MeshoptFilter;
using gltf::MeshoptMode;
using gltf::MeshoptView;

const gltf::SceneLimits kLimits = gltf::limits_within(3072);

using Blob = std::vector<std::uint8_t>;

template <typename T>
Blob bytes_of(const std::vector<T>& values) {
  Blob out(values.size() * sizeof(T));
  std::memcpy(out.data(), values.data(), out.size());
  return out;
}

/// A sheet of `n` by `n` squares in the plane z = 0, and the places of its corners.
struct Sheet {
  explicit Sheet(std::uint32_t n) {
    for (std::uint32_t y = 0; y <= n; ++y) {
      for (std::uint32_t x = 0; x <= n; ++x) {
        positions.insert(positions.end(),
                         {static_cast<float>(x), static_cast<float>(y), 0.0f, 1.0f});
      }
    }
    for (std::uint32_t y = 0; y < n; ++y) {
      for (std::uint32_t x = 0; x < n; ++x) {
        const std::uint32_t a = y * (n + 1) + x;
        const std::uint32_t b = a + n + 1;
        indices.insert(indices.end(), {a, a + 1, b + 1, a, b + 1, b});
      }
    }
  }
  std::vector<float> positions;  // x, y, z, 1
  std::vector<std::uint32_t> indices;
};

/// Adds a bufferView of `blob` in the form of EXT_meshopt_compression, over a buffer without
/// content.
int meshopt_view_of(Builder& builder, const Blob& blob, const char* mode, const char* filter,
                    std::size_t count, std::size_t stride,
                    const char* extension = "EXT_meshopt_compression") {
  const int raw = builder.view(blob);
  json& view = builder.doc["bufferViews"][static_cast<std::size_t>(raw)];
  json compressed = view;
  compressed.update({{"mode", mode}, {"count", count}, {"byteStride", stride}});
  if (*filter != '\0') compressed["filter"] = filter;
  view = {{"buffer", 1}, {"byteLength", count * stride}, {"extensions", {{extension, compressed}}}};
  return raw;
}

int accessor_over(Builder& builder, int view, int component_type, std::size_t count,
                  const char* type, bool normalized = false) {
  json accessor = {
      {"bufferView", view}, {"componentType", component_type}, {"count", count}, {"type", type}};
  if (normalized) accessor["normalized"] = true;
  builder.doc["accessors"].push_back(accessor);
  return static_cast<int>(builder.doc["accessors"].size()) - 1;
}

Blob encoded_vertices(const void* data, std::size_t count, std::size_t stride) {
  Blob out(meshopt_encodeVertexBufferBound(count, stride));
  out.resize(meshopt_encodeVertexBuffer(out.data(), out.size(), data, count, stride));
  return out;
}

Blob encoded_triangles(const std::vector<std::uint32_t>& indices, std::size_t vertices) {
  Blob out(meshopt_encodeIndexBufferBound(indices.size(), vertices));
  out.resize(meshopt_encodeIndexBuffer(out.data(), out.size(), indices.data(), indices.size()));
  return out;
}

Blob encoded_sequence(const std::vector<std::uint32_t>& indices, std::size_t vertices) {
  Blob out(meshopt_encodeIndexSequenceBound(indices.size(), vertices));
  out.resize(meshopt_encodeIndexSequence(out.data(), out.size(), indices.data(), indices.size()));
  return out;
}

/// Returns the sheet with positions through the vertex codec, and indices through that of `mode`.
Builder meshopt_sheet(const Sheet& sheet, const char* mode,
                      const char* extension = "EXT_meshopt_compression") {
  Builder builder;
  const std::size_t vertices = sheet.positions.size() / 4;
  const int positions =
      meshopt_view_of(builder, encoded_vertices(sheet.positions.data(), vertices, 16), "ATTRIBUTES",
                      "", vertices, 16, extension);
  builder.doc["bufferViews"][static_cast<std::size_t>(positions)]["byteStride"] = 16;
  const bool triangles = std::string(mode) == "TRIANGLES";
  const Blob blob = triangles ? encoded_triangles(sheet.indices, vertices)
                              : encoded_sequence(sheet.indices, vertices);
  const int indices = meshopt_view_of(builder, blob, mode, "", sheet.indices.size(), 4, extension);
  const int position = accessor_over(builder, positions, 5126, vertices, "VEC3");
  const int index = accessor_over(builder, indices, 5125, sheet.indices.size(), "SCALAR");
  builder.mesh({{"POSITION", position}}, index);
  builder.doc["extensionsUsed"] = builder.doc["extensionsRequired"] = {extension};
  builder.doc["buffers"] = {{{"byteLength", builder.bin.size()}},
                            {{"byteLength", vertices * 16 + sheet.indices.size() * 4},
                             {"extensions", {{extension, {{"fallback", true}}}}}}};
  return builder;
}

double area_of(const Scene& scene) {
  double area = 0;
  const Mesh& mesh = scene.objects[0].mesh;
  const double scale = scene.instances[0].world_from_object.scale;
  for (std::size_t i = 0; i < mesh.indices.size(); i += 3) {
    const glm::vec3 a = mesh.vertices[mesh.indices[i]].position;
    const glm::vec3 b = mesh.vertices[mesh.indices[i + 1]].position;
    const glm::vec3 c = mesh.vertices[mesh.indices[i + 2]].position;
    area += glm::cross(b - a, c - a).z / 2 * scale * scale;  // signed, so that winding counts
  }
  return area;
}

TEST(GltfMeshopt, VerticesTrianglesAndIndexSequences) {
  const Sheet sheet(20);
  for (const char* mode : {"TRIANGLES", "INDICES"}) {
    auto scene = meshopt_sheet(sheet, mode).load_strict();
    ASSERT_TRUE(scene) << failure(scene);
    EXPECT_TRUE(scene->warnings.empty()) << scene->warnings[0];
    EXPECT_EQ(scene->triangles(), 800u) << mode;
    EXPECT_NEAR(area_of(*scene), 400, 1e-3) << mode;
  }
  EXPECT_TRUE(meshopt_sheet(sheet, "TRIANGLES", "KHR_meshopt_compression").load().ok());
}

TEST(GltfMeshopt, Filters) {
  constexpr std::size_t kCount = 40;
  std::vector<float> unit;
  for (std::size_t i = 0; i < kCount; ++i) {
    const double angle = 0.37 * static_cast<double>(i);
    const glm::vec4 q = glm::normalize(glm::vec4(std::cos(angle), std::sin(angle), 0.3, 0.5));
    for (int c = 0; c < 4; ++c) unit.push_back(q[c]);
  }
  const auto decode = [&](const void* data, MeshoptFilter filter, std::uint32_t stride) {
    MeshoptView view{MeshoptMode::kAttributes, filter, kCount, stride};
    auto out = decode_meshopt(encoded_vertices(data, kCount, stride), view);
    EXPECT_TRUE(out.ok()) << out.error().line();
    return out.ok() ? out.take() : Blob(kCount * stride);
  };
  std::vector<std::int16_t> filtered(kCount * 4);
  const auto at = [](const Blob& blob, std::size_t i) {
    std::int16_t value;
    std::memcpy(&value, &blob[i * 2], 2);
    return value / 32767.0f;
  };
  meshopt_encodeFilterQuat(filtered.data(), kCount, 8, 16, unit.data());
  const Blob turns = decode(filtered.data(), MeshoptFilter::kQuaternion, 8);
  for (std::size_t i = 0; i < kCount; ++i) {
    float dot = 0;  // a quaternion and its negative are one rotation
    for (std::size_t c = 0; c < 4; ++c) dot += at(turns, i * 4 + c) * unit[i * 4 + c];
    EXPECT_NEAR(std::abs(dot), 1, 1e-3) << i;
  }
  std::vector<float> normals = unit;
  for (std::size_t i = 0; i < kCount; ++i) {
    const glm::vec3 n = glm::normalize(glm::vec3(unit[i * 4], unit[i * 4 + 1], unit[i * 4 + 2]));
    for (int c = 0; c < 3; ++c) normals[i * 4 + static_cast<std::size_t>(c)] = n[c];
  }
  meshopt_encodeFilterOct(filtered.data(), kCount, 8, 12, normals.data());
  const Blob sides = decode(filtered.data(), MeshoptFilter::kOctahedral, 8);
  for (std::size_t i = 0; i < kCount * 4; ++i) {
    if (i % 4 == 3) continue;  // not part of the vector
    EXPECT_NEAR(at(sides, i), normals[i], 2e-3) << i;
  }
  std::vector<std::uint32_t> exponential(kCount * 4);
  meshopt_encodeFilterExp(exponential.data(), kCount, 16, 15, unit.data());
  const Blob places = decode(exponential.data(), MeshoptFilter::kExponential, 16);
  for (std::size_t i = 0; i < kCount * 4; ++i) {
    float value;
    std::memcpy(&value, &places[i * 4], 4);
    EXPECT_NEAR(value, unit[i], 1e-3) << i;
  }
}

TEST(GltfMeshopt, WhatDoesNotFitIsRefused) {
  struct Case {
    const char* pointer;
    json value;
    ErrorId id;
  };
  const std::string own = "/bufferViews/0/extensions/EXT_meshopt_compression/";
  const Case cases[] = {
      {"mode", "TRIANGLES", ErrorId::kSceneFormat},    {"mode", "LINES", ErrorId::kSceneFormat},
      {"filter", "COLOR", ErrorId::kSceneExtension},   {"filter", "SHARPEN", ErrorId::kSceneFormat},
      {"filter", "QUATERNION", ErrorId::kSceneFormat}, {"byteStride", 3, ErrorId::kSceneFormat},
      {"byteStride", 0, ErrorId::kSceneFormat},        {"byteStride", 260, ErrorId::kSceneFormat},
      {"count", 40'000'000, ErrorId::kSceneLimit},     {"count", 1'000'000, ErrorId::kSceneFormat},
      {"count", 480, ErrorId::kSceneFormat},           {"byteLength", 40, ErrorId::kSceneFormat},
      {"byteLength", 1'000'000, ErrorId::kSceneRange}, {"buffer", 1, ErrorId::kSceneReference},
      {"buffer", 2, ErrorId::kSceneReference}};
  for (const Case& c : cases) {
    Builder builder = meshopt_sheet(Sheet(20), "TRIANGLES");
    builder.doc[json::json_pointer(own + c.pointer)] = c.value;
    const auto scene = builder.load();
    ASSERT_FALSE(scene.ok()) << c.pointer << " " << c.value;
    EXPECT_EQ(error_name(scene.error().id), error_name(c.id)) << scene.error().line();
    EXPECT_NE(scene.error().text.find("bufferViews[0]"), std::string::npos) << scene.error().line();
  }
  // Fewer elements than the accessors use.
  Builder fewer = meshopt_sheet(Sheet(20), "TRIANGLES");
  fewer.doc["accessors"][0]["count"] = 442;
  EXPECT_REFUSED(fewer.load(), kSceneRange, "accessors[0]");
  Builder later = meshopt_sheet(Sheet(20), "TRIANGLES", "KHR_meshopt_compression");
  later.bin[0] = static_cast<char>(0xa1);
  EXPECT_REFUSED(later.load(), kSceneExtension, "bitstream version 1");
}

#ifdef MIRAGE_DRACO

struct Encoded {
  Blob bytes;
  std::uint32_t position = 0;  // unique ids
  std::uint32_t color = 0;
};

Encoded encoded_sheet(const Sheet& sheet, int method) {
  draco::TriangleSoupMeshBuilder soup;
  const std::size_t faces = sheet.indices.size() / 3;
  soup.Start(static_cast<int>(faces));
  const int position = soup.AddAttribute(draco::GeometryAttribute::POSITION, 3, draco::DT_FLOAT32);
  const int color = soup.AddAttribute(draco::GeometryAttribute::COLOR, 4, draco::DT_UINT8);
  const std::uint8_t orange[] = {255, 128, 0, 255};
  for (std::size_t f = 0; f < faces; ++f) {
    const float* corners[3];
    for (std::size_t c = 0; c < 3; ++c) corners[c] = &sheet.positions[sheet.indices[f * 3 + c] * 4];
    const draco::FaceIndex face(static_cast<std::uint32_t>(f));
    soup.SetAttributeValuesForFace(position, face, corners[0], corners[1], corners[2]);
    soup.SetAttributeValuesForFace(color, face, orange, orange, orange);
  }
  const auto mesh = soup.Finalize();
  draco::Encoder encoder;
  encoder.SetEncodingMethod(method);
  draco::EncoderBuffer buffer;
  EXPECT_TRUE(encoder.EncodeMeshToBuffer(*mesh, &buffer).ok());
  Encoded out;
  out.bytes.assign(buffer.data(), buffer.data() + buffer.size());
  out.position = mesh->attribute(position)->unique_id();
  out.color = mesh->attribute(color)->unique_id();
  return out;
}

Builder draco_sheet(const Sheet& sheet, int method) {
  Builder builder;
  const Encoded encoded = encoded_sheet(sheet, method);
  const int view = builder.view(encoded.bytes);
  const std::size_t vertices = sheet.positions.size() / 4;
  builder.doc["accessors"] = {
      {{"componentType", 5126}, {"count", vertices}, {"type", "VEC3"}},
      {{"componentType", 5121}, {"count", vertices}, {"type", "VEC4"}, {"normalized", true}},
      {{"componentType", 5123}, {"count", sheet.indices.size()}, {"type", "SCALAR"}}};
  builder.mesh({{"POSITION", 0}, {"COLOR_0", 1}}, 2);
  builder.primitive()["extensions"]["KHR_draco_mesh_compression"] = {
      {"bufferView", view},
      {"attributes", {{"POSITION", encoded.position}, {"COLOR_0", encoded.color}}}};
  builder.doc["extensionsUsed"] =
      builder.doc["extensionsRequired"] = {"KHR_draco_mesh_compression"};
  return builder;
}

constexpr int kMethods[] = {draco::MESH_SEQUENTIAL_ENCODING, draco::MESH_EDGEBREAKER_ENCODING};

TEST(GltfDraco, BothMethods) {
  const Sheet sheet(12);
  for (const int method : kMethods) {
    auto scene = draco_sheet(sheet, method).load_strict();
    ASSERT_TRUE(scene) << failure(scene);
    EXPECT_TRUE(scene->warnings.empty()) << scene->warnings[0];
    EXPECT_EQ(scene->triangles(), 288u) << method;
    EXPECT_NEAR(area_of(*scene), 144, 1e-2) << method;
    const Vertex& vertex = scene->objects[0].mesh.vertices[0];
    EXPECT_NEAR(vertex.color.y / 65535.0, 128 / 255.0, 1e-3) << method;
    EXPECT_EQ(vertex.color.z, 0) << method;
  }
}

TEST(GltfDraco, TheTinygltfInUseIsTheRealOne) {
  // libdraco has functions with the same names; see MirageDependencies.cmake.
  void* parser = dlsym(RTLD_DEFAULT,
                       "_ZN8tinygltf8TinyGLTF19LoadASCIIFromStringEPNS_5ModelEPNSt7__cxx1112basic_"
                       "stringIcSt11char_traitsIcESaIcEEES9_PKcjRKS8_j");
  Dl_info info{};
  ASSERT_TRUE(parser != nullptr && dladdr(parser, &info) != 0);
  EXPECT_NE(std::string(info.dli_fname).find("tinygltf"), std::string::npos) << info.dli_fname;
}

TEST(GltfDraco, PrimitivesMayShareAccessors) {
  Builder builder = draco_sheet(Sheet(12), draco::MESH_EDGEBREAKER_ENCODING);
  json& primitives = builder.doc["meshes"][0]["primitives"];
  primitives.push_back(primitives[0]);
  auto scene = builder.load_strict();
  ASSERT_TRUE(scene) << failure(scene);
  EXPECT_EQ(scene->triangles(), 576u);
}

TEST(GltfDraco, TrianglesOfAllPrimitivesAreCounted) {
  Builder builder = draco_sheet(Sheet(4), draco::MESH_EDGEBREAKER_ENCODING);
  // The data claim three times 5 million triangles of 3 vertices.
  const Blob claim = {'D', 'R', 'A', 'C', 'O', 2, 2, 1, 1, 0, 0, 0, 3, 0xc0, 0x96, 0xb1, 2};
  std::memcpy(builder.bin.data(), claim.data(), claim.size());
  json& primitives = builder.doc["meshes"][0]["primitives"];
  EXPECT_REFUSED(builder.load(), kSceneFormat, "Draco");
  primitives.push_back(primitives[0]);
  primitives.push_back(primitives[0]);
  EXPECT_REFUSED(builder.load(), kSceneLimit, "triangles of Draco");
}

TEST(GltfDraco, OtherCountsThanDeclaredAreForgiven) {
  Builder builder = draco_sheet(Sheet(12), draco::MESH_EDGEBREAKER_ENCODING);
  builder.doc["accessors"][0]["count"] = 3;
  builder.doc["accessors"][2]["count"] = 2'000'000'000;
  auto scene = builder.load();
  ASSERT_TRUE(scene) << failure(scene);
  EXPECT_EQ(scene->triangles(), 288u);
  EXPECT_TRUE(has_warning(*scene, "1 Draco meshes of other counts"));
  EXPECT_REFUSED(builder.load_strict(), kSceneRange, "declared are others");
}

TEST(GltfDraco, WhatDoesNotFitIsRefused) {
  Builder id = draco_sheet(Sheet(4), draco::MESH_EDGEBREAKER_ENCODING);
  id.primitive()["extensions"]["KHR_draco_mesh_compression"]["attributes"]["POSITION"] = 77;
  EXPECT_REFUSED(id.load(), kSceneFormat, "meshes[0].primitives[0]: Draco: no attribute 77");
  Builder view = draco_sheet(Sheet(4), draco::MESH_EDGEBREAKER_ENCODING);
  view.primitive()["extensions"]["KHR_draco_mesh_compression"]["bufferView"] = 9;
  EXPECT_REFUSED(view.load(), kSceneReference, "bufferView = 9");
  Builder range = draco_sheet(Sheet(4), draco::MESH_EDGEBREAKER_ENCODING);
  range.doc["bufferViews"][0]["byteLength"] = 1 << 20;
  EXPECT_REFUSED(range.load(), kSceneRange, "meshes[0].primitives[0]");
  Builder type = draco_sheet(Sheet(4), draco::MESH_EDGEBREAKER_ENCODING);
  type.doc["accessors"][0]["type"] = "MAT4";
  EXPECT_REFUSED(type.load(), kSceneFormat, "impossible type");
}

TEST(GltfDraco, CutAndChangedBytesEndCleanly) {
  for (const int method : kMethods) {
    const Encoded whole = encoded_sheet(Sheet(6), method);
    const DracoAttribute wanted[] = {{whole.position, 5126, 3}, {whole.color, 5121, 4}};
    ASSERT_TRUE(decode_draco(whole.bytes, wanted, kLimits).ok());
    for (std::size_t size = 0; size < whole.bytes.size(); ++size) {
      const Blob cut(whole.bytes.begin(), whole.bytes.begin() + static_cast<std::ptrdiff_t>(size));
      const auto mesh = decode_draco(cut, wanted, kLimits);
      EXPECT_FALSE(mesh.ok() && size + 16 < whole.bytes.size()) << size;
      Blob changed = whole.bytes;
      changed[size] ^= 0xff;
      const auto other = decode_draco(changed, wanted, kLimits);
      if (!other) continue;
      for (const std::uint32_t index : other->indices) ASSERT_LT(index, other->points);
      EXPECT_EQ(other->attributes[0].size(), other->points * 12u);
    }
  }
}

TEST(GltfDraco, CountsAreJudgedBeforeAnythingIsAllocated) {
  const auto header = [](int method, std::initializer_list<int> rest) {
    Blob out = {'D', 'R', 'A', 'C', 'O', 2, 2, 1, static_cast<std::uint8_t>(method), 0, 0};
    for (const int byte : rest) out.push_back(static_cast<std::uint8_t>(byte));
    return out;
  };
  // The data claim 2^31 triangles of 3 vertices, or as a sequential mesh 1 of 2^31.
  EXPECT_REFUSED(decode_draco(header(1, {0, 3, 0x80, 0x80, 0x80, 0x80, 8}), {}, kLimits),
                 kSceneLimit, "2147483648 triangles");
  EXPECT_REFUSED(decode_draco(header(0, {1, 0x80, 0x80, 0x80, 0x80, 8}), {}, kLimits), kSceneLimit,
                 "2147483648 vertices");
  EXPECT_REFUSED(decode_draco(header(1, {0, 3}), {}, kLimits), kSceneFormat, "ends before");
  EXPECT_REFUSED(decode_draco(header(2, {0, 3, 1}), {}, kLimits), kSceneFormat, "method");
  Blob old = header(1, {0, 3, 1});
  old[6] = 1;
  EXPECT_REFUSED(decode_draco(old, {}, kLimits), kSceneFormat, "bitstream 2.1");
}

#endif

}  // namespace
}  // namespace mirage::test
