// KHR_materials_anisotropy on import: values, values out of range, and the tangents it is drawn
// along.

#include <cmath>

#include "tests/support/gltf_fixture.h"

namespace mirage::test {
namespace {

constexpr const char* kName = "KHR_materials_anisotropy";
constexpr const char* kNoTangents = "1 primitives without tangents drawn without anisotropy";

/// A PNG of one texel: 255, 128, 64.
constexpr const char* kTexel =
    "data:image/png;base64,iVBORw0KGgoAAAANSUhEUgAAAAEAAAABCAIAAACQd1PeAAAADElEQVR4nGP43+AAAARBAc"
    "AM0e2RAAAAAElFTkSuQmCC";

/// A triangle with this extension; its texture coordinates run along y and then against x.
Builder brushed(const json& extension) {
  Builder builder = triangle();
  builder.primitive()["attributes"]["TEXCOORD_0"] = builder.vec2({0, 0, 0, -1, 1, 0});
  builder.primitive()["material"] = 0;
  builder.doc["materials"] = {{{"extensions", {{kName, extension}}}}};
  builder.doc["images"] = {{{"uri", kTexel}}};
  builder.doc["textures"] = {{{"source", 0}}};
  builder.doc["extensionsUsed"] = builder.doc["extensionsRequired"] = {kName};
  return builder;
}

Lobes lobes_of(const Builder& builder) {
  auto scene = builder.load();
  EXPECT_TRUE(scene) << failure(scene);
  return scene ? scene->materials.at(0).lobes : Lobes();
}

TEST(GltfAnisotropy, ValuesAndTexture) {
  auto scene = brushed({{"anisotropyStrength", 0.625},
                        {"anisotropyRotation", 1.5},
                        {"anisotropyTexture", {{"index", 0}}}})
                   .load_strict();
  ASSERT_TRUE(scene) << failure(scene);
  EXPECT_TRUE(scene->warnings.empty()) << scene->warnings[0];
  const Lobes& l = scene->materials.at(0).lobes;
  EXPECT_EQ(l.anisotropy, 0.625f);
  EXPECT_EQ(l.anisotropy_rotation, 1.5f);
  const TextureRef& map = l.map(LobeMap::kAnisotropy);
  ASSERT_TRUE(map.present());
  const Image& image = scene->images.at(static_cast<std::size_t>(map.image));
  EXPECT_FALSE(image.srgb) << "directions are data";
  EXPECT_EQ(image.rgba, (std::vector<std::uint8_t>{255, 128, 64, 255}));
}

TEST(GltfAnisotropy, IsAbsentByDefault) {
  const Lobes l = lobes_of(brushed(json::object()));
  EXPECT_EQ(l.anisotropy, 0);
  EXPECT_EQ(l.anisotropy_rotation, 0);
  EXPECT_FALSE(l.map(LobeMap::kAnisotropy).present());
}

TEST(GltfAnisotropy, StrengthIsClamped) {
  for (const auto& [strength, is] : {std::pair{1.5, 1.0f}, {-0.5, 0.0f}, {1e300, 1.0f}}) {
    auto scene = brushed({{"anisotropyStrength", strength}}).load();
    ASSERT_TRUE(scene) << failure(scene);
    EXPECT_EQ(scene->materials[0].lobes.anisotropy, is) << strength;
    EXPECT_TRUE(has_warning(*scene, "1 material factors out of range clamped")) << strength;
  }
}

TEST(GltfAnisotropy, RotationIsWithinHalfATurn) {
  const double pi = std::acos(-1.0);
  for (const auto& [angle, is] :
       {std::pair{-1.0, pi - 1}, {4 * pi + 1, 1.0}, {pi + 0.5, 0.5}, {0.0, 0.0}}) {
    const Lobes l = lobes_of(brushed({{"anisotropyStrength", 1}, {"anisotropyRotation", angle}}));
    EXPECT_NEAR(l.anisotropy_rotation, is, 1e-6) << angle;
  }
  for (const double angle : {-1e-30, 1e300, -1e300, pi, -pi}) {
    const Lobes l = lobes_of(brushed({{"anisotropyStrength", 1}, {"anisotropyRotation", angle}}));
    EXPECT_GE(l.anisotropy_rotation, 0) << angle;
    EXPECT_LE(l.anisotropy_rotation, kMaxGrainRotation) << angle;
  }
}

TEST(GltfAnisotropy, WhatIsNoNumberIsLeftOut) {
  for (const char* key : {"anisotropyStrength", "anisotropyRotation"}) {
    for (const json& value : {json("1"), json(nullptr), json::array({1}), json(true),
                              json(std::nan(""))}) {  // NaN is written as null
      EXPECT_REFUSED(brushed({{key, value}}).load_strict(), kSceneFormat, key);
      const Result<Scene> without = brushed({{key, value}}).load();
      EXPECT_TRUE(without) << failure(without);
    }
  }
  EXPECT_REFUSED(brushed(json::array()).load_strict(), kSceneFormat, kName);
  EXPECT_REFUSED(brushed({{"anisotropyTexture", 0}}).load_strict(), kSceneFormat,
                 "anisotropyTexture");
  EXPECT_REFUSED(brushed({{"anisotropyTexture", json::object()}}).load_strict(), kSceneFormat,
                 "index");
  EXPECT_REFUSED(brushed({{"anisotropyTexture", {{"index", 7}}}}).load_strict(), kSceneReference,
                 "anisotropyTexture");
}

TEST(GltfAnisotropy, TangentsAreMadeOfTextureCoordinates) {
  auto scene = brushed({{"anisotropyStrength", 0.5}}).load();
  ASSERT_TRUE(scene) << failure(scene);
  EXPECT_TRUE(scene->warnings.empty()) << scene->warnings[0];
  for (const Vertex& v : scene->objects[0].mesh.vertices) {
    EXPECT_NEAR(v.tangent.y, 1, 1e-6f) << "u grows along y";
    EXPECT_NEAR(glm::length(glm::vec3(v.tangent)), 1, 1e-6f);
  }
}

// A material without a direction along its surface is drawn without anisotropy; elsewhere it keeps
// it.
TEST(GltfAnisotropy, WithoutTangentsItIsLeftOutAndTold) {
  Builder builder = brushed({{"anisotropyStrength", 0.5},
                             {"anisotropyRotation", 1},
                             {"anisotropyTexture", {{"index", 0}}}});
  json bare = builder.primitive();
  bare["attributes"].erase("TEXCOORD_0");
  builder.doc["meshes"][0]["primitives"].push_back(bare);
  auto scene = builder.load();
  ASSERT_TRUE(scene) << failure(scene);
  EXPECT_TRUE(has_warning(*scene, kNoTangents));
  ASSERT_EQ(scene->materials.size(), 2u);
  EXPECT_EQ(scene->materials[0].lobes.anisotropy, 0.5f);
  EXPECT_EQ(scene->materials[1].lobes.anisotropy, 0);
  EXPECT_EQ(scene->materials[1].lobes.anisotropy_rotation, 0);
  EXPECT_FALSE(scene->materials[1].lobes.map(LobeMap::kAnisotropy).present());
  const auto& primitives = scene->objects[0].mesh.primitives;
  ASSERT_EQ(primitives.size(), 2u);
  EXPECT_NE(primitives[0].material, primitives[1].material);
}

TEST(GltfAnisotropy, TangentsOfTheFileNeedNoTextureCoordinates) {
  Builder builder = brushed({{"anisotropyStrength", 0.5}});
  json& attributes = builder.primitive()["attributes"];
  attributes.erase("TEXCOORD_0");
  attributes["TANGENT"] = builder.vec4({0, 1, 0, -1, 0, 1, 0, -1, 0, 1, 0, -1});
  auto without_normals = builder.load();
  ASSERT_TRUE(without_normals) << failure(without_normals);
  EXPECT_TRUE(has_warning(*without_normals, kNoTangents))
      << "glTF ignores tangents without normals";
  builder.primitive()["attributes"]["NORMAL"] = builder.vec3({0, 0, 1, 0, 0, 1, 0, 0, 1});
  auto scene = builder.load();
  ASSERT_TRUE(scene) << failure(scene);
  EXPECT_TRUE(scene->warnings.empty()) << scene->warnings[0];
  EXPECT_EQ(scene->materials[0].lobes.anisotropy, 0.5f);
  EXPECT_EQ(scene->objects[0].mesh.vertices[0].tangent, glm::vec4(0, 1, 0, -1));
}

// A file without the extension is unchanged: one material, no warning.
TEST(GltfAnisotropy, WhatHasNoneNeedsNoTangents) {
  for (const json& extension : {json::object(), json{{"anisotropyRotation", 1}}}) {
    Builder builder = brushed(extension);
    json bare = builder.primitive();
    bare["attributes"].erase("TEXCOORD_0");
    builder.doc["meshes"][0]["primitives"].push_back(bare);
    auto scene = builder.load();
    ASSERT_TRUE(scene) << failure(scene);
    EXPECT_TRUE(scene->warnings.empty()) << scene->warnings[0];
    EXPECT_EQ(scene->materials.size(), 1u);
  }
  Builder unlit = brushed({{"anisotropyStrength", 0.5}});
  unlit.doc["materials"][0]["extensions"]["KHR_materials_unlit"] = json::object();
  unlit.primitive()["attributes"].erase("TEXCOORD_0");
  auto scene = unlit.load();
  ASSERT_TRUE(scene) << failure(scene);
  EXPECT_FALSE(has_warning(*scene, "anisotropy"));
  EXPECT_EQ(scene->materials[0].lobes.anisotropy, 0);
}

}  // namespace
}  // namespace mirage::test
