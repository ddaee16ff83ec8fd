// KTX2 textures: the bytes of the original transcoder, files that use them, and damaged ones.
#include <openssl/sha.h>

#include <fstream>
#include <iterator>
#include <random>
#include <sstream>

#include "modules/ktx2_header.h"
#include "modules/ktx2_library.h"
#include "tests/support/gltf_fixture.h"

namespace mirage::test {
namespace {

const std::string kFolder = MIRAGE_SOURCE_DIR "/tests/server/scene/gltf/ktx2/";

using Bytes = std::vector<std::uint8_t>;

Bytes file_bytes(const std::string& name) {
  std::ifstream file(kFolder + name, std::ios::binary);
  return {std::istreambuf_iterator<char>(file), {}};
}

std::string sum_of(const Bytes& bytes) {
  std::array<unsigned char, SHA256_DIGEST_LENGTH> sum{};
  SHA256(bytes.data(), bytes.size(), sum.data());
  std::ostringstream out;
  for (const unsigned char c : sum) out << std::hex << (c >> 4) << (c & 15);
  return out.str();
}

/// A triangle whose only texture is a KTX2 file without a fallback.
Builder ktx2_triangle(const Bytes& bytes) {
  Builder builder = triangle();
  builder.primitive()["attributes"]["TEXCOORD_0"] = builder.vec2({0, 0, 1, 0, 0, 1});
  const int view = builder.view(std::vector<char>(bytes.begin(), bytes.end()));
  builder.doc["images"] = {{{"bufferView", view}, {"mimeType", "image/ktx2"}}};
  builder.doc["textures"] = {{{"extensions", {{"KHR_texture_basisu", {{"source", 0}}}}}}};
  builder.doc["materials"] = {{{"pbrMetallicRoughness", {{"baseColorTexture", {{"index", 0}}}}}}};
  builder.doc["extensionsUsed"] = builder.doc["extensionsRequired"] = {"KHR_texture_basisu"};
  builder.primitive()["material"] = 0;
  return builder;
}

class GltfKtx2 : public testing::Test {
 protected:
  void SetUp() override {
    if (!ktx2_library()) GTEST_SKIP() << "this build does not read KTX2 (scripts/setup-ktx2)";
  }
};

TEST_F(GltfKtx2, BytesAreThoseOfTheOriginalTranscoder) {
  std::ifstream table(kFolder + "reference.tsv");
  std::string name, sum;
  std::uint32_t level = 0, width = 0, height = 0;
  int levels = 0;
  while (table >> name >> level >> width >> height >> sum) {
    const Result<Ktx2Pixels> pixels = (*ktx2_library())->decode(file_bytes(name), level);
    ASSERT_TRUE(pixels) << name << ": " << pixels.error().text;
    EXPECT_EQ(pixels->width, width) << name;
    EXPECT_EQ(pixels->height, height) << name;
    EXPECT_EQ(sum_of(pixels->rgba), sum) << name << ", level " << level;
    ++levels;
  }
  EXPECT_EQ(levels, 24);
}

TEST_F(GltfKtx2, ATextureWithoutAFallbackIsRead) {
  const Bytes bytes = file_bytes("uastc_alpha.ktx2");
  const Result<Scene> scene = ktx2_triangle(bytes).load();
  ASSERT_TRUE(scene) << failure(scene);
  EXPECT_TRUE(scene->warnings.empty());
  ASSERT_EQ(scene->images.size(), 1u);
  EXPECT_EQ(scene->images[0].width, 61u);
  EXPECT_EQ(scene->images[0].height, 47u);
  EXPECT_TRUE(scene->images[0].srgb);
  EXPECT_EQ(scene->images[0].rgba, (*ktx2_library())->decode(bytes, 0)->rgba);
}

TEST_F(GltfKtx2, ADamagedTextureCostsItself) {
  const Bytes good = file_bytes("etc1s_alpha.ktx2");
  for (const std::size_t kept : {std::size_t{12}, std::size_t{30}, good.size() / 2}) {
    const Result<Scene> scene = ktx2_triangle({good.begin(), good.begin() + kept}).load();
    ASSERT_TRUE(scene) << failure(scene);
    EXPECT_TRUE(has_warning(*scene, "1 unreadable images left out")) << kept << " bytes";
  }
}

TEST_F(GltfKtx2, AnyBytesGiveAPictureOfTheHeadersSizeOrAnError) {
  std::mt19937 random(1);
  int pictures = 0;
  for (const char* name : {"etc1s_alpha.ktx2", "uastc_zstd.ktx2"}) {
    const Bytes good = file_bytes(name);
    for (int round = 0; round < 400; ++round) {
      Bytes bytes = good;
      for (int k = 0; k <= round % 3; ++k) {
        bytes[random() % bytes.size()] = static_cast<std::uint8_t>(random());
      }
      const Result<Ktx2Pixels> pixels = (*ktx2_library())->decode(bytes, 0);
      if (!pixels) continue;
      ++pictures;
      const Result<Ktx2Header> header = read_ktx2_header(bytes);
      ASSERT_TRUE(header);
      EXPECT_EQ(pixels->rgba.size(), std::size_t{4} * header->width * header->height);
    }
  }
  EXPECT_GT(pictures, 100);
}

}  // namespace
}  // namespace mirage::test
