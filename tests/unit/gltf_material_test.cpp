// Materials, textures and the images behind them.
#include <array>

#include "gltf_fixture.h"

namespace mirage::test {
namespace {

std::string big_endian(std::uint32_t value) {
  return {static_cast<char>(value >> 24), static_cast<char>(value >> 16),
          static_cast<char>(value >> 8), static_cast<char>(value)};
}

std::uint32_t crc32(const std::string& bytes) {
  std::uint32_t crc = 0xffffffffu;
  for (const char c : bytes) {
    crc ^= static_cast<unsigned char>(c);
    for (int bit = 0; bit < 8; ++bit) crc = crc >> 1 ^ ((crc & 1) != 0 ? 0xedb88320u : 0u);
  }
  return ~crc;
}

std::string png_chunk(const std::string& type, const std::string& data) {
  return big_endian(static_cast<std::uint32_t>(data.size())) + type + data +
         big_endian(crc32(type + data));
}

/// PNG whose pixels are stored, not compressed. `color_type`: 0 grey, 2 RGB, 4 grey-alpha, 6 RGBA.
std::string make_png(std::uint32_t width, std::uint32_t height, int depth, int color_type,
                     const std::string& pixels) {
  std::string rows;
  const std::size_t row = height > 0 ? pixels.size() / height : 0;
  for (std::size_t y = 0; y < height && row > 0; ++y) {
    rows += std::string(1, '\0') + pixels.substr(y * row, row);
  }
  std::uint32_t a = 1;
  std::uint32_t b = 0;
  for (const char c : rows) {
    a = (a + static_cast<unsigned char>(c)) % 65521;
    b = (b + a) % 65521;
  }
  const auto size = static_cast<std::uint16_t>(rows.size());
  const std::string block = {'\1', static_cast<char>(size), static_cast<char>(size >> 8),
                             static_cast<char>(~size), static_cast<char>(~size >> 8)};
  const std::string header = big_endian(width) + big_endian(height) + static_cast<char>(depth) +
                             static_cast<char>(color_type) + std::string(3, '\0');
  return "\x89PNG\r\n\x1a\n" + png_chunk("IHDR", header) +
         png_chunk("IDAT", "\x78\x01" + block + rows + big_endian(b << 16 | a)) +
         png_chunk("IEND", "");
}

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
  // TEXCOORD_1 is absent: set 0 stands in, and is told.
  EXPECT_TRUE(has_warning(*scene, "lack the texture coordinates"));
  const Vertex& vertex = scene->objects[0].mesh.vertices[1];
  EXPECT_EQ(vertex.uv1, vertex.uv0);
}

TEST(GltfMaterial, HighTextureCoordinateSetsFallBack) {
  json material = base_color();
  material["pbrMetallicRoughness"]["baseColorTexture"]["texCoord"] = 6;
  auto scene = textured(make_png(1, 1, 8, 2, "abc"), material).load();
  ASSERT_TRUE(scene) << failure(scene);
  EXPECT_EQ(scene->materials[0].base_color_map.uv_set, 0);
  EXPECT_TRUE(has_warning(*scene, "TEXCOORD_2 or higher"));
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
  // Unassociated: a half transparent pixel keeps its full colour, so does an invisible one.
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

TEST(GltfImage, TooLargeImagesAreRefusedByName) {
  for (const unsigned edge : {16384u, 65535u}) {
    Builder builder = textured(make_png(edge, edge, 8, 2, "abc"), base_color());
    EXPECT_REFUSED(builder.load(), kSceneLimit, "images[0]");
  }
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
  builder.doc["textures"][0]["source"] = 0;  // the fallback wins where there is one
  auto fallback = builder.load();
  ASSERT_TRUE(fallback) << failure(fallback);
  EXPECT_EQ(first_pixel(*fallback), Pixel({'a', 'b', 'c', 255}));
}

TEST(GltfImage, FilesAreGuardedLikeBuffers) {
  Builder builder = textured(make_png(1, 1, 8, 2, "abc"), base_color());
  builder.doc["images"] = {{{"uri", "../x.png"}}};
  EXPECT_REFUSED(builder.load(), kSceneUri, "images[0]");
  builder.doc["images"] = {{{"uri", "x.png"}}};
  EXPECT_REFUSED(builder.load_strict(), kSceneMissing, "images[0]");
  auto without = builder.load();
  ASSERT_TRUE(without) << failure(without);
  EXPECT_TRUE(has_warning(*without, "1 missing image files left out"));
  EXPECT_FALSE(without->materials[0].base_color_map.present());
  builder.doc["images"] = {json::object()};
  EXPECT_REFUSED(builder.load(), kSceneFormat, "images[0]");
}

}  // namespace
}  // namespace mirage::test
