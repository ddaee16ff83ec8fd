// Materials, textures and the images behind them.
#include <array>

#include "modules/ktx2_library.h"
#include "server/scene/gltf/image_decode.h"
#include "tests/support/gltf_fixture.h"
#include "tests/support/png_builder.h"

namespace mirage::test {
namespace {

/// A triangle with one material over one image.
Builder textured(const std::string& image, const json& material) {
  Builder builder = triangle();
  builder.primitive()["attributes"]["TEXCOORD_0"] = builder.vec2({0, 0, 1, 0, 0, 1});
  const int view = builder.view(std::vector<char>(image.begin(), image.end()));
  builder.doc["images"] = {{{"bufferView", view}, {"mimeType", "image/png"}}};
  builder.doc["textures"] = {{{"source", 0}}};
  builder.doc["materials"] = json::array({material});
  builder.primitive()["material"] = 0;
  return builder;
}

json base_color() { return {{"pbrMetallicRoughness", {{"baseColorTexture", {{"index", 0}}}}}}; }

Result<Scene> with_image(const std::string& image) { return textured(image, base_color()).load(); }

std::vector<std::uint8_t> first_pixel(const Scene& scene) {
  return {scene.images[0].rgba.begin(), scene.images[0].rgba.begin() + 4};
}

using Pixel = std::vector<std::uint8_t>;

TEST(GltfMaterial, DefaultMaterial) {
  auto scene = triangle().load();
  ASSERT_TRUE(scene);
  ASSERT_EQ(scene->materials.size(), 1u);
  EXPECT_EQ(scene->materials[0].base_color, glm::vec4(1));
  EXPECT_EQ(scene->materials[0].metallic, 1);
  EXPECT_EQ(scene->materials[0].roughness, 1);
}

TEST(GltfMaterial, FactorsAndModes) {
  Builder builder = triangle();
  builder.primitive()["material"] = 0;
  builder.doc["materials"] = {
      {{"pbrMetallicRoughness",
        {{"baseColorFactor", {0.25, 0.5, 2, 1}}, {"metallicFactor", 0}, {"roughnessFactor", 0.5}}},
       {"emissiveFactor", {1, 0, 0}},
       {"alphaMode", "MASK"},
       {"alphaCutoff", 0.25},
       {"doubleSided", true},
       {"extensions",
        {{"KHR_materials_unlit", json::object()},
         {"KHR_materials_emissive_strength", {{"emissiveStrength", 4}}}}}}};
  auto scene = builder.load();
  ASSERT_TRUE(scene) << failure(scene);
  const Material& material = scene->materials[0];
  EXPECT_EQ(material.base_color, glm::vec4(0.25f, 0.5f, 1, 1));
  EXPECT_EQ(material.metallic, 0);
  EXPECT_EQ(material.roughness, 0.5f);
  EXPECT_EQ(material.emissive, glm::vec3(4, 0, 0));
  EXPECT_EQ(material.alpha_mode, AlphaMode::kMask);
  EXPECT_EQ(material.alpha_cutoff, 0.25f);
  EXPECT_TRUE(material.double_sided);
  EXPECT_TRUE(material.unlit);
  EXPECT_TRUE(has_warning(*scene, "1 material factors"));
}

TEST(GltfMaterial, SamplerAndTransform) {
  json material = base_color();
  material["pbrMetallicRoughness"]["baseColorTexture"]["extensions"]["KHR_texture_transform"] = {
      {"offset", {0.5, 0.25}}, {"scale", {2, 3}}, {"rotation", 1}, {"texCoord", 1}};
  Builder builder = textured(make_png(1, 1, 8, 2, "abc"), material);
  builder.doc["samplers"] = {{{"wrapS", 33071}, {"wrapT", 33648}, {"magFilter", 9728}}};
  builder.doc["textures"][0]["sampler"] = 0;
  auto scene = builder.load();
  ASSERT_TRUE(scene) << failure(scene);
  const TextureRef& ref = scene->materials[0].base_color_map;
  EXPECT_EQ(ref.wrap_s, Wrap::kClamp);
  EXPECT_EQ(ref.wrap_t, Wrap::kMirror);
  EXPECT_TRUE(ref.nearest);
  EXPECT_EQ(ref.offset, glm::vec2(0.5f, 0.25f));
  EXPECT_EQ(ref.scale, glm::vec2(2, 3));
  EXPECT_EQ(ref.rotation, 1);
  EXPECT_EQ(ref.uv_set, 1);
  // TEXCOORD_1 is absent: set 0 is used instead, with a warning.
  EXPECT_TRUE(has_warning(*scene, "lack the texture coordinates"));
  const Vertex& vertex = scene->objects[0].mesh.vertices[1];
  EXPECT_EQ(vertex.uv1, vertex.uv0);
}

// Vertices have two sets of texture coordinates; a material may use any two of the file's. A map of
// a third set would lie in a wrong place.
TEST(GltfMaterial, AnyTwoSetsOfTextureCoordinatesAreRead) {
  json material = base_color();
  material["pbrMetallicRoughness"]["baseColorTexture"]["texCoord"] = 3;
  Builder builder = textured(make_png(1, 1, 8, 2, "abc"), material);
  json& attributes = builder.primitive()["attributes"];
  attributes["TEXCOORD_1"] = builder.vec2({9, 9, 9, 9, 9, 9});
  attributes["TEXCOORD_2"] = builder.vec2({2, 0, 2, 1, 2, 2});
  attributes["TEXCOORD_3"] = builder.vec2({3, 0, 3, 1, 3, 2});
  auto alone = builder.load_strict();
  ASSERT_TRUE(alone) << failure(alone);
  EXPECT_EQ(alone->materials[0].base_color_map.uv_set, 0);
  EXPECT_EQ(alone->objects[0].mesh.vertices[1].uv0, glm::vec2(3, 1));

  builder.doc["materials"][0]["emissiveTexture"] = {{"index", 0}, {"texCoord", 2}};
  auto two = builder.load_strict();
  ASSERT_TRUE(two) << failure(two);
  EXPECT_EQ(two->materials[0].emissive_map.uv_set, 0);
  EXPECT_EQ(two->materials[0].base_color_map.uv_set, 1);
  EXPECT_EQ(two->objects[0].mesh.vertices[2].uv0, glm::vec2(2, 2));
  EXPECT_EQ(two->objects[0].mesh.vertices[2].uv1, glm::vec2(3, 2));
  EXPECT_TRUE(two->warnings.empty());

  builder.doc["materials"][0]["occlusionTexture"] = {{"index", 0}};
  auto three = builder.load_strict();
  ASSERT_TRUE(three) << failure(three);
  EXPECT_TRUE(has_warning(*three, "a third set of texture coordinates"));
  EXPECT_FALSE(three->materials[0].occlusion_map.present());
  EXPECT_EQ(three->materials[0].base_color_map.uv_set, 0);
}

// Most files that name a third set have one that repeats, turns or scales another.
TEST(GltfMaterial, SetsThatOthersGiveAreReadThroughThose) {
  json material = base_color();
  material["pbrMetallicRoughness"]["baseColorTexture"]["texCoord"] = 1;
  material["emissiveTexture"] = {{"index", 0}, {"texCoord", 2}};
  material["emissiveFactor"] = {1, 1, 1};
  material["normalTexture"] = {
      {"index", 0},
      {"texCoord", 3},
      {"extensions", {{"KHR_texture_transform", {{"offset", {0.5, 0}}, {"scale", {2, 2}}}}}}};
  Builder builder = textured(make_png(1, 1, 8, 2, "abc"), material);
  json& attributes = builder.primitive()["attributes"];
  attributes["TEXCOORD_1"] = builder.vec2({0, 0, 1, 0, 0, 1});
  attributes["TEXCOORD_2"] = builder.vec2({0.25, 0.25, 0.25, 0.25, 0.25, 0.25});
  attributes["TEXCOORD_3"] = builder.vec2({1, 3, 1, 4, 0, 3});  // (1 - v, 3 + u)
  auto scene = builder.load_strict();
  ASSERT_TRUE(scene) << failure(scene);
  EXPECT_TRUE(scene->warnings.empty());
  const Material& m = scene->materials[0];
  const Vertex& vertex = scene->objects[0].mesh.vertices[2];
  EXPECT_EQ(vertex.uv0, glm::vec2(0, 1));
  EXPECT_EQ(m.base_color_map.scale, glm::vec2(1));
  for (const TextureRef* map : {&m.base_color_map, &m.emissive_map, &m.normal_map}) {
    EXPECT_EQ(map->uv_set, 0);
  }
  EXPECT_EQ(m.emissive_map.scale, glm::vec2(0));
  EXPECT_NEAR(m.emissive_map.offset.x, 0.25f, 1e-6f);
  // 2 (1 - v, 3 + u) + (0.5, 0), as mesh_pass.cpp computes it.
  const TextureRef& n = m.normal_map;
  const float c = std::cos(n.rotation), s = std::sin(n.rotation);
  EXPECT_NEAR(n.scale.x * c * 0.25f + n.scale.y * s * 0.5f + n.offset.x, 1.5f, 1e-5f);
  EXPECT_NEAR(-n.scale.x * s * 0.25f + n.scale.y * c * 0.5f + n.offset.y, 6.5f, 1e-5f);
}

TEST(GltfMaterial, LobesAreRead) {
  json material = base_color();
  material["extensions"] = {
      {"KHR_materials_specular",
       {{"specularFactor", 0.5},
        {"specularColorFactor", {0.5, 1, 2}},
        {"specularTexture", {{"index", 0}}}}},
      {"KHR_materials_ior", {{"ior", 1.33}}},
      {"KHR_materials_clearcoat", {{"clearcoatFactor", 0.75}, {"clearcoatRoughnessFactor", 0.25}}},
      {"KHR_materials_sheen", {{"sheenColorFactor", {0, 0.5, 7}}, {"sheenRoughnessFactor", 0.125}}},
      {"KHR_materials_transmission", {{"transmissionFactor", 0.5}}},
      {"KHR_materials_volume",
       {{"thicknessFactor", 2}, {"attenuationDistance", 1}, {"attenuationColor", {1, 0.5, 0.25}}}}};
  auto scene = textured(make_png(1, 1, 8, 2, "abc"), material).load();
  ASSERT_TRUE(scene) << failure(scene);
  const Material& out = scene->materials[0];
  const Lobes& l = out.lobes;
  EXPECT_EQ(l.specular, 0.5f);
  EXPECT_EQ(l.specular_color, glm::vec3(0.5f, 1, 2));
  EXPECT_TRUE(l.map(LobeMap::kSpecular).present());
  EXPECT_FLOAT_EQ(l.ior, 1.33f);
  EXPECT_EQ(l.clearcoat, 0.75f);
  EXPECT_EQ(l.clearcoat_roughness, 0.25f);
  EXPECT_EQ(l.sheen_color, glm::vec3(0, 0.5f, 1)) << "clamped";
  EXPECT_EQ(l.transmission, 0.5f);
  EXPECT_EQ(out.alpha_mode, AlphaMode::kBlend);
  EXPECT_NEAR(l.volume_tint.g, 0.25f, 1e-6f);
}

TEST(GltfMaterial, ImageForColourAndDataIsStoredTwice) {
  json material = base_color();
  material["emissiveTexture"] = {{"index", 0}};
  material["occlusionTexture"] = {{"index", 0}};
  auto scene = textured(make_png(1, 1, 8, 2, "abc"), material).load();
  ASSERT_TRUE(scene) << failure(scene);
  ASSERT_EQ(scene->images.size(), 2u);
  const Material& out = scene->materials[0];
  EXPECT_EQ(out.base_color_map.image, out.emissive_map.image);
  EXPECT_TRUE(scene->images[static_cast<std::size_t>(out.base_color_map.image)].srgb);
  EXPECT_FALSE(scene->images[static_cast<std::size_t>(out.occlusion_map.image)].srgb);
  EXPECT_EQ(scene->images[0].rgba, scene->images[1].rgba);
}

TEST(GltfImage, PixelFormats) {
  auto pixel = [](int depth, int color_type, const std::string& bytes) {
    auto scene = with_image(make_png(1, 1, depth, color_type, bytes));
    EXPECT_TRUE(scene) << failure(scene);
    EXPECT_FALSE(has_warning(*scene, "unreadable"));
    return first_pixel(*scene);
  };
  EXPECT_EQ(pixel(8, 0, "\x40"), Pixel({64, 64, 64, 255}));
  EXPECT_EQ(pixel(8, 2, "\x10\x20\x30"), Pixel({16, 32, 48, 255}));
  EXPECT_EQ(pixel(8, 4, "\x40\x80"), Pixel({64, 64, 64, 128}));
  // Alpha is not associated: a half transparent pixel keeps its full colour, and so does an
  // invisible one.
  EXPECT_EQ(pixel(8, 6, "\x7f\x20\x30\x40"), Pixel({127, 32, 48, 64}));
  EXPECT_EQ(pixel(8, 6, std::string("\x7f\x20\x30\0", 4)), Pixel({127, 32, 48, 0}));
  EXPECT_EQ(pixel(16, 0, std::string("\x80\x80", 2)), Pixel({128, 128, 128, 255}));
}

TEST(GltfImage, FirstRowStaysFirst) {
  auto scene = with_image(make_png(1, 2, 8, 0, "\x01\x02"));
  ASSERT_TRUE(scene) << failure(scene);
  EXPECT_EQ(scene->images[0].rgba[0], 1);
  EXPECT_EQ(scene->images[0].rgba[4], 2);
}

TEST(GltfImage, UnreadableImagesAreWhite) {
  const std::string good = make_png(4, 4, 8, 2, std::string(48, 'x'));
  for (const std::string& bytes :
       {std::string("garbage garbage garbage"), good.substr(0, 40),
        good.substr(0, good.size() - 20), make_png(0, 0, 8, 2, ""), make_png(4, 4, 8, 2, "abc")}) {
    auto scene = with_image(bytes);
    ASSERT_TRUE(scene) << failure(scene);
    EXPECT_TRUE(has_warning(*scene, "1 unreadable images left out")) << bytes.size();
    EXPECT_FALSE(scene->materials[0].base_color_map.present()) << bytes.size();
    EXPECT_REFUSED(textured(bytes, base_color()).load_strict(), kSceneFormat, "images[0]");
    EXPECT_EQ(scene->images[0].width, 1u);
    EXPECT_EQ(first_pixel(*scene), Pixel({255, 255, 255, 255}));
  }
}

/// A PNG with the byte for interlacing; decoders hold such an image whole.
std::string interlaced(std::uint32_t width, std::uint32_t height) {
  std::string header = big_endian(width) + big_endian(height) + std::string("\10\2\0\0\1", 5);
  return "\x89PNG\r\n\x1a\n" + png_chunk("IHDR", header) + png_chunk("IEND", "");
}

TEST(GltfImage, TooLargeImagesAreRefusedByName) {
  for (const std::string& image : {make_png(65535, 65535, 8, 2, "abc"),
                                   make_png(16385, 1, 8, 2, "abc"), interlaced(16384, 16384)}) {
    EXPECT_REFUSED(textured(image, base_color()).load(), kSceneLimit, "images[0]");
  }
}

/// Returns `count` images of a size that is only claimed, each used by a material of its own.
Builder many_images(std::size_t count, std::uint32_t edge) {
  Builder builder = textured(make_png(edge, edge, 8, 2, "abc"), base_color());
  const json primitive = builder.primitive();
  for (std::size_t i = 1; i < count; ++i) {
    builder.doc["images"].push_back(builder.doc["images"][0]);
    builder.doc["textures"].push_back({{"source", i}});
    builder.doc["materials"].push_back(builder.doc["materials"][0]);
    builder.doc["materials"][i]["pbrMetallicRoughness"]["baseColorTexture"]["index"] = i;
    builder.doc["meshes"][0]["primitives"].push_back(primitive);
    builder.doc["meshes"][0]["primitives"][i]["material"] = i;
  }
  return builder;
}

TEST(GltfImage, MorePixelsThanFitAreReduced) {
  auto fits = many_images(2, 8192).load();
  ASSERT_TRUE(fits) << failure(fits);
  EXPECT_FALSE(has_warning(*fits, "reduced to fit"));
  auto scene = many_images(3, 8192).load();  // 192 Mi pixels, of which 128 Mi are held
  ASSERT_TRUE(scene) << failure(scene);
  EXPECT_TRUE(has_warning(*scene, "2 images reduced to fit"));
  EXPECT_REFUSED(many_images(3, 8192).load_strict(), kSceneLimit, "are held");
  EXPECT_TRUE(has_warning(*many_images(1, 16384).load(), "1 images reduced to fit"));
  EXPECT_REFUSED(many_images(9, 8192).load(), kSceneLimit, "pixels in images");
}

TEST(GltfImage, ReducedImagesKeepTheirLight) {
  using gltf::decode_image;
  // Black and white by turns, 5 x 4 pixels; the last column has no partner and joins the second.
  const std::string row = {'\0', '\xff', '\0', '\xff', '\0'};
  const std::string png = make_png(5, 4, 8, 0, row + row + row + row);
  const auto bytes = std::span(reinterpret_cast<const std::uint8_t*>(png.data()), png.size());
  auto color = decode_image(bytes, 1, true);
  ASSERT_TRUE(color) << color.error().line();
  ASSERT_EQ(color->width, 2u);
  ASSERT_EQ(color->height, 2u);
  EXPECT_EQ(color->rgba[0], 188);  // half the light, IEC 61966-2-1
  EXPECT_EQ(color->rgba[4], 156);  // a third
  EXPECT_EQ(color->rgba[3], 255);
  const std::string grey = make_png(4, 4, 8, 0, std::string(16, '\x64'));
  auto even = decode_image(
      std::span(reinterpret_cast<const std::uint8_t*>(grey.data()), grey.size()), 1, true);
  ASSERT_TRUE(even) << even.error().line();
  EXPECT_EQ(even->rgba[0], 100);
  auto data = decode_image(bytes, 1, false);
  ASSERT_TRUE(data) << data.error().line();
  EXPECT_EQ(data->rgba[0], 128);
  EXPECT_EQ(data->rgba[4], 85);
  auto least = decode_image(bytes, 9, false);
  ASSERT_TRUE(least) << least.error().line();
  EXPECT_EQ(least->rgba.size(), 4u);
  EXPECT_EQ(least->rgba[0], 102);  // two of five
}

TEST(GltfImage, WebpExtension) {
  Builder builder = textured(make_png(1, 1, 8, 2, "abc"), base_color());
  builder.doc["extensionsRequired"] = {"EXT_texture_webp"};
  // A lossless WebP of one transparent pixel.
  builder.doc["images"].push_back(
      {{"uri", "data:image/webp;base64,UklGRhoAAABXRUJQVlA4TA0AAAAvAAAAEAcQERGIiP4HAA=="}});
  builder.doc["textures"] = {{{"extensions", {{"EXT_texture_webp", {{"source", 1}}}}}}};
  auto scene = builder.load();
  ASSERT_TRUE(scene) << failure(scene);
  EXPECT_FALSE(has_warning(*scene, "unreadable"));
  EXPECT_EQ(first_pixel(*scene)[3], 0);
  builder.doc["textures"][0]["source"] = 0;  // a fallback wins
  auto fallback = builder.load();
  ASSERT_TRUE(fallback) << failure(fallback);
  EXPECT_EQ(first_pixel(*fallback), Pixel({'a', 'b', 'c', 255}));
}

TEST(GltfImage, FilesAreGuardedLikeBuffers) {
  Builder builder = textured(make_png(1, 1, 8, 2, "abc"), base_color());
  builder.doc["images"] = {{{"uri", "../x.png"}}};
  EXPECT_REFUSED(builder.load_strict(), kSceneUri, "images[0]");
  EXPECT_TRUE(builder.load().ok());
  builder.doc["images"] = {{{"uri", "x.png"}}};
  EXPECT_REFUSED(builder.load_strict(), kSceneMissing, "images[0]");
  auto without = builder.load();
  ASSERT_TRUE(without) << failure(without);
  EXPECT_TRUE(has_warning(*without, "1 missing image files left out"));
  EXPECT_FALSE(without->materials[0].base_color_map.present());
  builder.doc["images"] = {json::object()};
  EXPECT_REFUSED(builder.load_strict(), kSceneFormat, "images[0]");
}

TEST(GltfVariants, TheChosenOneElseTheFilesOwn) {
  Builder builder = triangle();
  builder.doc["materials"] = {{{"pbrMetallicRoughness", {{"metallicFactor", 0.25}}}},
                              {{"pbrMetallicRoughness", {{"metallicFactor", 0.5}}}},
                              {{"pbrMetallicRoughness", {{"metallicFactor", 0.75}}}}};
  builder.primitive()["material"] = 0;
  builder.primitive()["extensions"]["KHR_materials_variants"]["mappings"] = {
      {{"material", 1}, {"variants", {0}}}, {{"material", 2}, {"variants", {2}}}};
  builder.doc["extensions"]["KHR_materials_variants"]["variants"] = {
      {{"name", "red"}}, {{"name", "plain"}}, {{"name", "dark blue"}}};
  builder.doc["extensionsUsed"] = builder.doc["extensionsRequired"] = {"KHR_materials_variants"};
  const TempFolder folder;
  const std::string file = folder.write("scene.glb", builder.glb());
  const auto metallic = [&](const std::string& query) {
    auto scene = import_gltf_spec(file + query);
    EXPECT_TRUE(scene) << failure(scene);
    return scene ? scene->materials[0].metallic : -1;
  };
  EXPECT_EQ(metallic(""), 0.25f);
  EXPECT_EQ(metallic("?variant=red"), 0.5f);
  EXPECT_EQ(metallic("?variant=plain"), 0.25f);  // this variant maps no primitive
  EXPECT_EQ(metallic("?variant=dark blue"), 0.75f);
  const SceneChoices choices = import_gltf_spec(file + "?variant=red").take().choices;
  EXPECT_EQ(choices.variants, (std::vector<std::string>{"red", "plain", "dark blue"}));
  EXPECT_EQ(choices.shown.variant, "red");
  auto unknown = import_gltf_spec(file + "?variant=green");
  EXPECT_REFUSED(unknown, kUsage, "no variant 'green'");
  EXPECT_EQ(unknown.error().hint, "its variants: red, plain, dark blue");
  EXPECT_REFUSED(import_gltf_spec(file + "?colour=red"), kUsage, "?variant=NAME");
  EXPECT_REFUSED(import_gltf_spec(file + "?variant="), kUsage, "?variant=NAME");
  EXPECT_TRUE(import_gltf_spec(folder.write("a?b.glb", builder.glb())).ok());

  builder.doc["extensions"]["KHR_materials_variants"]["variants"][2]["name"] = "red";
  auto twice = builder.load({.choice = {.clip = "", .variant = "red"}});
  ASSERT_TRUE(twice) << failure(twice);
  EXPECT_EQ(twice->materials[0].metallic, 0.5f);
  EXPECT_TRUE(has_warning(*twice, "1 variants of one name"));
  EXPECT_REFUSED(builder.load_strict(), kSceneFormat, "two variants named 'red'");
  builder.primitive()["extensions"]["KHR_materials_variants"]["mappings"][0]["variants"] = {3};
  EXPECT_REFUSED(builder.load_strict(), kSceneReference, "but there are 3 variants");
}

TEST(GltfImage, BasisuUsesItsFallbackElseSaysHowToConvert) {
  Builder builder = textured(make_png(1, 1, 8, 2, "abc"), base_color());
  builder.doc["images"].push_back({{"bufferView", 0}, {"mimeType", "image/ktx2"}});
  builder.doc["textures"][0]["extensions"]["KHR_texture_basisu"]["source"] = 1;
  builder.doc["extensionsUsed"] = {"KHR_texture_basisu"};
  auto scene = builder.load();
  ASSERT_TRUE(scene) << failure(scene);
  EXPECT_EQ(first_pixel(*scene), Pixel({'a', 'b', 'c', 255}));
  EXPECT_TRUE(has_warning(*scene, "1 textures of KHR_texture_basisu use their fallback"));

  if (ktx2_library()) return;  // ktx2_test.cpp
  builder.doc["textures"][0].erase("source");
  auto without = builder.load();
  EXPECT_REFUSED(without, kSceneExtension, "textures[0] is of KHR_texture_basisu");
  EXPECT_NE(without.error().hint.find("gltf-transform/cli ktxdecompress"), std::string::npos);
}

/// A material of KHR_materials_pbrSpecularGlossiness over one image.
Builder spec_gloss(const std::string& image, const json& values) {
  Builder builder = textured(image, json::object());
  builder.doc["materials"][0]["extensions"]["KHR_materials_pbrSpecularGlossiness"] = values;
  builder.doc["extensionsUsed"] = {"KHR_materials_pbrSpecularGlossiness"};
  return builder;
}

TEST(GltfSpecGloss, FactorsBecomeDielectricsAndMetals) {
  const std::string image = make_png(1, 1, 8, 2, "abc");
  auto plastic = spec_gloss(image, {{"diffuseFactor", {0.5, 0.25, 0, 0.5}},
                                    {"specularFactor", {0.04, 0.04, 0.04}},
                                    {"glossinessFactor", 0.75}})
                     .load_strict();
  ASSERT_TRUE(plastic) << failure(plastic);
  EXPECT_TRUE(plastic->warnings.empty()) << plastic->warnings[0];
  const Material& a = plastic->materials[0];
  EXPECT_NEAR(a.metallic, 0, 1e-5);
  EXPECT_FLOAT_EQ(a.roughness, 0.25f);
  EXPECT_NEAR(a.base_color.x, 0.5, 1e-5);
  EXPECT_NEAR(a.base_color.y, 0.25, 1e-5);
  EXPECT_EQ(a.base_color.w, 0.5f);

  // Gold: no diffuse colour, a coloured highlight.
  auto gold =
      spec_gloss(image, {{"diffuseFactor", {0, 0, 0, 1}}, {"specularFactor", {1, 0.75, 0.25}}})
          .load_strict();
  ASSERT_TRUE(gold) << failure(gold);
  const Material& b = gold->materials[0];
  EXPECT_NEAR(b.metallic, 1, 1e-5);
  EXPECT_EQ(b.roughness, 0);
  EXPECT_NEAR(b.base_color.y, 0.75, 1e-5);
  EXPECT_NEAR(b.base_color.z, 0.25, 1e-5);
}

TEST(GltfSpecGloss, TexturesAreConvertedTexelByTexel) {
  // Left is a dielectric of half gloss, right a metal of full gloss, where the diffuse image is
  // black.
  const std::string specular = make_png(2, 1, 8, 6, std::string("\0\0\0\x80\xff\xff\0\xff", 8));
  Builder builder = spec_gloss(specular, {{"diffuseTexture", {{"index", 1}}},
                                          {"specularGlossinessTexture", {{"index", 0}}}});
  const std::string diffuse = make_png(2, 1, 8, 2, std::string("\x80\x40\x20\0\0\0", 6));
  const int view = builder.view(std::vector<char>(diffuse.begin(), diffuse.end()));
  builder.doc["images"].push_back({{"bufferView", view}, {"mimeType", "image/png"}});
  builder.doc["textures"].push_back({{"source", 1}});
  auto scene = builder.load_strict();
  ASSERT_TRUE(scene) << failure(scene);
  const Material& material = scene->materials[0];
  EXPECT_EQ(material.base_color, glm::vec4(1));
  ASSERT_TRUE(material.base_color_map.present() && material.metal_rough_map.present());
  const Image& base = scene->images[static_cast<std::size_t>(material.base_color_map.image)];
  const Image& data = scene->images[static_cast<std::size_t>(material.metal_rough_map.image)];
  EXPECT_TRUE(base.srgb);
  EXPECT_FALSE(data.srgb);
  ASSERT_EQ(base.rgba.size(), 8u);
  ASSERT_EQ(data.rgba.size(), 8u);
  EXPECT_NEAR(base.rgba[0], 0x82, 1);  // without the highlight of a dielectric: 1 / .96 of it
  EXPECT_NEAR(base.rgba[2], 0x21, 1);
  EXPECT_EQ(data.rgba[1], 127);
  EXPECT_EQ(data.rgba[2], 0);
  EXPECT_EQ(base.rgba[4], 255);
  EXPECT_EQ(base.rgba[6], 0);
  EXPECT_EQ(data.rgba[5], 0);
  EXPECT_EQ(data.rgba[6], 255);
  // Another place on the surface: a warning, and the colour stays the diffuse one.
  builder.doc["materials"][0]["extensions"]["KHR_materials_pbrSpecularGlossiness"]
             ["specularGlossinessTexture"]["texCoord"] = 1;
  auto other = builder.load();
  ASSERT_TRUE(other) << failure(other);
  EXPECT_TRUE(has_warning(*other, "otherwise than the diffuse one"));
}

TEST(GltfSpecGloss, ADiffuseTextureAloneStaysAsItIs) {
  Builder builder = spec_gloss(make_png(1, 1, 8, 2, "abc"),
                               {{"diffuseTexture", {{"index", 0}}}, {"specularFactor", {0, 0, 0}}});
  auto scene = builder.load_strict();
  ASSERT_TRUE(scene) << failure(scene);
  EXPECT_EQ(scene->images.size(), 1u);
  EXPECT_EQ(first_pixel(*scene), Pixel({'a', 'b', 'c', 255}));
  EXPECT_EQ(scene->materials[0].metallic, 0);
  // An unreadable image leaves the factors.
  builder.doc["images"][0]["bufferView"] = 0;
  builder.doc["materials"][0]["extensions"]["KHR_materials_pbrSpecularGlossiness"] = {
      {"diffuseFactor", {0, 0, 1, 1}},
      {"specularGlossinessTexture", {{"index", 0}}},
      {"specularFactor", {0, 0, 0}}};
  auto broken = builder.load();
  ASSERT_TRUE(broken) << failure(broken);
  const auto place = static_cast<std::size_t>(broken->materials[0].base_color_map.image);
  EXPECT_EQ(broken->images[place].rgba[0], 0);
  EXPECT_EQ(broken->images[place].rgba[2], 255);
}

}  // namespace
}  // namespace mirage::test
