// Geometry: modes, attributes, mending of defects, morph targets and skins.
#include <cmath>
#include <limits>

#include "tests/support/gltf_fixture.h"

namespace mirage::test {
namespace {

constexpr float kNan = std::numeric_limits<float>::quiet_NaN();

/// Five points of a zigzag, drawn in the given mode.
Result<Scene> zigzag(int mode) {
  Builder builder;
  const int position = builder.vec3({0, 0, 0, 1, 0, 0, 0, 1, 0, 1, 1, 0, 0, 2, 0});
  builder.mesh({{"POSITION", position}}, -1, mode);
  return builder.load();
}

glm::vec3 face_normal(const Mesh& mesh, std::size_t triangle) {
  const glm::vec3 a = mesh.vertices[mesh.indices[triangle * 3]].position;
  const glm::vec3 b = mesh.vertices[mesh.indices[triangle * 3 + 1]].position;
  const glm::vec3 c = mesh.vertices[mesh.indices[triangle * 3 + 2]].position;
  return glm::normalize(glm::cross(b - a, c - a));
}

TEST(GltfGeometry, ModesExpand) {
  struct Case {
    int mode;
    PrimitiveKind kind;
    std::uint32_t indices;
  };
  for (const Case& item :
       {Case{0, PrimitiveKind::kPoints, 5}, Case{1, PrimitiveKind::kLines, 4},
        Case{2, PrimitiveKind::kLines, 10}, Case{3, PrimitiveKind::kLines, 8},
        Case{4, PrimitiveKind::kTriangles, 3}, Case{5, PrimitiveKind::kTriangles, 9}}) {
    auto scene = zigzag(item.mode);
    ASSERT_TRUE(scene) << failure(scene);
    const Primitive& primitive = scene->objects[0].mesh.primitives[0];
    EXPECT_EQ(primitive.kind, item.kind) << item.mode;
    EXPECT_EQ(primitive.index_count, item.indices) << item.mode;
    EXPECT_EQ(scene->materials[primitive.material].unlit, item.mode < 4) << item.mode;
  }
}

TEST(GltfGeometry, StripsAndFansKeepTheirWinding) {
  auto strip = zigzag(5);
  ASSERT_TRUE(strip);
  for (std::size_t i = 0; i < 3; ++i) {
    EXPECT_EQ(face_normal(strip->objects[0].mesh, i), glm::vec3(0, 0, 1)) << i;
  }
  Builder builder;
  builder.mesh({{"POSITION", builder.vec3({0, 0, 0, 1, 0, 0, 1, 1, 0, 0, 1, 0})}}, -1, 6);
  auto fan = builder.load();
  ASSERT_TRUE(fan);
  EXPECT_EQ(fan->triangles(), 2u);
  EXPECT_EQ(face_normal(fan->objects[0].mesh, 0), glm::vec3(0, 0, 1));
  EXPECT_EQ(face_normal(fan->objects[0].mesh, 1), glm::vec3(0, 0, 1));
}

TEST(GltfGeometry, IndexTypes) {
  for (const int type : {5121, 5123, 5125}) {
    Builder builder;
    const int position = builder.vec3({0, 0, 0, 1, 0, 0, 0, 1, 0});
    int indices = 0;
    if (type == 5121) indices = builder.accessor<std::uint8_t>({0, 2, 1}, "SCALAR", type, 1);
    if (type == 5123) indices = builder.accessor<std::uint16_t>({0, 2, 1}, "SCALAR", type, 1);
    if (type == 5125) indices = builder.accessor<std::uint32_t>({0, 2, 1}, "SCALAR", type, 1);
    builder.mesh({{"POSITION", position}}, indices);
    auto scene = builder.load();
    ASSERT_TRUE(scene) << failure(scene);
    EXPECT_EQ(face_normal(scene->objects[0].mesh, 0), glm::vec3(0, 0, -1)) << type;
  }
}

TEST(GltfGeometry, MissingNormalsAreFlat) {
  auto scene = triangle().load();
  ASSERT_TRUE(scene);
  for (const Vertex& vertex : scene->objects[0].mesh.vertices) {
    EXPECT_EQ(vertex.normal, glm::vec3(0, 0, 1));
    EXPECT_NEAR(glm::length(glm::vec3(vertex.tangent)), 1, 1e-6);
  }
}

TEST(GltfGeometry, BadNormalsBecomeFaceNormals) {
  Builder builder = triangle();
  const int normal = builder.vec3({0, 0, 0, kNan, 0, 0, 0, 3, 4});
  builder.primitive()["attributes"]["NORMAL"] = normal;
  auto scene = builder.load();
  ASSERT_TRUE(scene);
  const auto& vertices = scene->objects[0].mesh.vertices;
  EXPECT_EQ(vertices[0].normal, glm::vec3(0, 0, 1));
  EXPECT_EQ(vertices[1].normal, glm::vec3(0, 0, 1));
  EXPECT_NEAR(vertices[2].normal.y, 0.6, 1e-6);
  EXPECT_TRUE(has_warning(*scene, "2 normals"));
}

TEST(GltfGeometry, DefectiveTrianglesGoAndAreCounted) {
  Builder builder;
  const int position = builder.vec3({0, 0, 0, 1, 0, 0, 0, 1, 0, kNan, 0, 0, 3e38f, 0, 0, 2, 0, 0});
  const int normal = builder.vec3(std::vector<float>(18, 1.0f));
  // Triangles: good, NaN, huge, beyond the end, restart value, repeated corner, collinear.
  const int indices =
      builder.indices({0, 1, 2, 0, 1, 3, 0, 1, 4, 0, 1, 6, 0, 1, 65535, 0, 1, 1, 0, 1, 5});
  builder.mesh({{"POSITION", position}, {"NORMAL", normal}}, indices);
  auto scene = builder.load();
  ASSERT_TRUE(scene) << failure(scene);
  EXPECT_EQ(scene->triangles(), 1u);
  EXPECT_EQ(scene->objects[0].mesh.vertices.size(), 3u);  // the NaN vertex is gone
  EXPECT_TRUE(has_warning(*scene, "2 triangles with an index beyond"));
  EXPECT_TRUE(has_warning(*scene, "2 triangles with a position"));
  EXPECT_TRUE(has_warning(*scene, "2 triangles without area"));
}

TEST(GltfGeometry, TinyTrianglesKeepTheirNormals) {
  Builder builder;
  builder.mesh({{"POSITION", builder.vec3({0, 0, 0, 1e-30f, 0, 0, 0, 1e-30f, 0})}});
  auto scene = builder.load();
  ASSERT_TRUE(scene);
  ASSERT_EQ(scene->triangles(), 1u);
  EXPECT_EQ(scene->objects[0].mesh.vertices[0].normal, glm::vec3(0, 0, 1));
}

TEST(GltfGeometry, AttributesOfAllKinds) {
  Builder builder = triangle();
  json& attributes = builder.primitive()["attributes"];
  const int uv = builder.accessor<std::uint16_t>({0, 65535, 0, 0, 65535, 0}, "VEC2", 5123, 2, true);
  const int color = builder.accessor<std::uint8_t>({255, 0, 0, 128, 0, 255, 0, 255, 0, 0, 255, 255},
                                                   "VEC4", 5121, 4, true);
  attributes["TEXCOORD_0"] = uv;
  attributes["TEXCOORD_1"] = builder.vec2({kNan, 0.25f, 0, 0, 0, 0});
  attributes["COLOR_0"] = color;
  auto scene = builder.load();
  ASSERT_TRUE(scene) << failure(scene);
  const Vertex& vertex = scene->objects[0].mesh.vertices[0];
  EXPECT_EQ(vertex.uv0, glm::vec2(0, 1));
  EXPECT_EQ(vertex.uv1, glm::vec2(0, 0.25f));
  EXPECT_EQ(vertex.color, glm::u16vec4(65535, 0, 0, 128 * 257));
  EXPECT_TRUE(has_warning(*scene, "1 texture coordinates"));
}

TEST(GltfGeometry, QuantizedAndInterleaved) {
  Builder builder;
  // Positions are int16, not normalised, each with 4 bytes of padding behind it.
  const std::vector<std::int16_t> raw = {0, 0, 0, 9, 9, 9, 100, 0, 0, 9, 9, 9, 0, 100, 0, 9, 9, 9};
  const int view = builder.view(raw, 12);
  builder.doc["accessors"] = {
      {{"bufferView", view}, {"componentType", 5122}, {"count", 3}, {"type", "VEC3"}}};
  builder.mesh({{"POSITION", 0}});
  auto scene = builder.load();
  ASSERT_TRUE(scene) << failure(scene);
  EXPECT_EQ(scene->objects[0].mesh.vertices[1].position, glm::vec3(100, 0, 0));
}

TEST(GltfGeometry, TangentsFromTextureCoordinates) {
  for (const bool mirrored : {false, true}) {
    Builder builder = triangle();
    const float u = mirrored ? -1.0f : 1.0f;
    builder.primitive()["attributes"]["TEXCOORD_0"] = builder.vec2({0, 1, u, 1, 0, 0});
    builder.primitive()["material"] = 0;
    builder.doc["materials"] = {{{"normalTexture", {{"index", 0}}}}};
    builder.doc["textures"] = {{{"source", 0}}};
    builder.doc["images"] = {{{"uri", "data:image/png;base64,AAAA"}}};
    auto scene = builder.load();
    ASSERT_TRUE(scene) << failure(scene);
    // u runs along x, v down; the bitangent cross(normal, tangent) * w points up, along +y.
    const Vertex& vertex = scene->objects[0].mesh.vertices[0];
    const glm::vec3 tangent(vertex.tangent);
    EXPECT_NEAR(tangent.x, u, 1e-6);
    const glm::vec3 bitangent = glm::cross(vertex.normal, tangent) * vertex.tangent.w;
    EXPECT_NEAR(bitangent.y, 1, 1e-6) << mirrored;
  }
}

TEST(GltfGeometry, MorphTargetsAtTheirDefaultWeights) {
  Builder builder = triangle();
  const int delta = builder.vec3({0, 0, 2, 0, 0, 2, 0, 0, 2});
  builder.primitive()["targets"] = json::array({{{"POSITION", delta}}});
  builder.doc["meshes"][0]["weights"] = {0.5};
  builder.doc["nodes"].push_back({{"mesh", 0}, {"weights", {1.0}}});
  auto scene = builder.load();
  ASSERT_TRUE(scene) << failure(scene);
  ASSERT_EQ(scene->objects.size(), 2u);  // two sets of weights, two shapes
  EXPECT_EQ(scene->objects[0].mesh.vertices[0].position.z, 1);
  EXPECT_EQ(scene->objects[1].mesh.vertices[0].position.z, 2);
}

Builder skinned(std::uint8_t joint) {
  Builder builder = triangle();
  json& attributes = builder.primitive()["attributes"];
  std::vector<std::uint8_t> joints(12, 0);
  joints[0] = joint;
  attributes["JOINTS_0"] = builder.accessor(joints, "VEC4", 5121, 4);
  attributes["WEIGHTS_0"] = builder.vec4({2, 0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0});
  std::vector<float> inverse_bind(16, 0.0f);
  for (const std::size_t i : {0, 5, 10, 15}) inverse_bind[i] = 1;
  inverse_bind[12] = -1;
  const int matrices = builder.accessor(inverse_bind, "MAT4", 5126, 16);
  builder.doc["skins"] = {{{"joints", {1}}, {"inverseBindMatrices", matrices}}};
  builder.doc["nodes"][0]["skin"] = 0;
  builder.doc["nodes"][0]["translation"] = {100, 0, 0};
  builder.doc["nodes"].push_back({{"translation", {0, 0, 7}}});
  return builder;
}

TEST(GltfGeometry, SkinsPoseTheMeshAndIgnoreItsNode) {
  auto scene = skinned(0).load();
  ASSERT_TRUE(scene) << failure(scene);
  EXPECT_EQ(scene->objects[0].mesh.vertices[0].position, glm::vec3(-1, 0, 7));
  EXPECT_EQ(scene->instances[0].world_from_object.position, glm::dvec3(0));
}

TEST(GltfGeometry, BrokenSkinsLeaveTheMeshUnskinned) {
  auto bad_joint = skinned(3).load();
  ASSERT_TRUE(bad_joint) << failure(bad_joint);
  EXPECT_TRUE(has_warning(*bad_joint, "unskinned"));
  EXPECT_EQ(bad_joint->objects[0].mesh.vertices[0].position, glm::vec3(0));

  Builder builder = skinned(0);
  builder.doc["skins"][0]["inverseBindMatrices"] = 0;  // an accessor of positions, not of matrices
  auto bad_matrices = builder.load();
  ASSERT_TRUE(bad_matrices) << failure(bad_matrices);
  EXPECT_TRUE(has_warning(*bad_matrices, "broken skin"));
  EXPECT_EQ(bad_matrices->instances[0].world_from_object.position, glm::dvec3(100, 0, 0));
}

TEST(GltfGeometry, AccessorsWithoutViewAreZeros) {
  // Zeros for indices as well: all corners coincide, and nothing is drawn.
  Builder builder = triangle();
  builder.doc["accessors"].push_back({{"componentType", 5123}, {"count", 3}, {"type", "SCALAR"}});
  builder.primitive()["indices"] = 1;
  auto scene = builder.load_strict();
  ASSERT_TRUE(scene) << failure(scene);
  EXPECT_TRUE(scene->instances.empty());
  // Sparse values replace some of the zeros.
  const int places = builder.view(std::vector<std::uint16_t>{1, 2});
  const int values = builder.view(std::vector<std::uint16_t>{1, 2});
  builder.doc["accessors"][1]["sparse"] = {
      {"count", 2},
      {"indices", {{"bufferView", places}, {"componentType", 5123}}},
      {"values", {{"bufferView", values}}}};
  auto sparse = builder.load_strict();
  ASSERT_TRUE(sparse) << failure(sparse);
  EXPECT_EQ(sparse->triangles(), 1u);
  builder.doc["accessors"].push_back({{"componentType", 5126}, {"count", 3}, {"type", "VEC4"}});
  builder.primitive()["attributes"]["COLOR_0"] = 2;
  auto black = builder.load_strict();
  ASSERT_TRUE(black) << failure(black);
  EXPECT_EQ(black->objects[0].mesh.vertices[0].color, glm::u16vec4(0));
}

}  // namespace
}  // namespace mirage::test
