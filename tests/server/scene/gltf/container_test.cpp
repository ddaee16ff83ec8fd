// Container, JSON, URIs, references and ranges: what is refused, and with which error.
#include <sys/stat.h>

#include <chrono>

#include "tests/support/gltf_fixture.h"

namespace mirage::test {
namespace {

namespace fs = std::filesystem;

Result<Scene> load_text(const std::string& bytes, const std::string& name = "scene.gltf",
                        bool strict = false, std::uint64_t megabytes = 1000) {
  const TempFolder folder;
  return import_gltf(folder.write(name, bytes), Workers(),
                     {.strict = strict, .megabytes = megabytes});
}

TEST(GltfContainer, PlainTriangleLoads) {
  auto scene = triangle().load();
  ASSERT_TRUE(scene) << failure(scene);
  EXPECT_EQ(scene->triangles(), 1u);
  EXPECT_TRUE(scene->warnings.empty());
}

TEST(GltfContainer, MissingFileAndFolder) {
  const TempFolder folder;
  EXPECT_REFUSED(import_gltf((folder.path() / "no.glb").string()), kSceneMissing, "no.glb");
  EXPECT_REFUSED(import_gltf(folder.path().string()), kSceneMissing, "not a regular file");
  EXPECT_EQ(import_gltf("no.glb").error().text, "no.glb: no such file") << "named once";
}

TEST(GltfContainer, WhatIsNoGltf) {
  EXPECT_REFUSED(load_text(""), kSceneFormat, "empty");
  EXPECT_REFUSED(load_text("\x89PNG\r\n\x1a\n1234", "a.glb"), kSceneFormat, "PNG");
  EXPECT_REFUSED(load_text("<html></html>"), kSceneFormat, "HTML");
  EXPECT_REFUSED(load_text("Just some words.", "a.glb"), kSceneFormat, "neither GLB nor JSON");
  std::string stl(84 + 2 * 50, ' ');
  stl.replace(80, 4, u32_bytes(2));
  const std::vector<std::pair<std::string, std::string>> kinds = {
      {"version https://git-lfs.github.com/spec/v1\noid sha256:5e\nsize 1\n", "Git LFS"},
      {R"({"asset":{"version":"1.1"},"geometricError":5,"root":{}})", "3D Tiles"},
      {"# made by hand\nmtllib a.mtl\nv 0 0 0\n", "OBJ"},
      {"solid cube\n facet normal 0 0 1\n", "STL"},
      {stl, "STL"},
      {"Kaydara FBX Binary  ", "FBX"},
      {"#usda 1.0\n", "USD"},
      {"PXR-USDC", "USD"},
      {"ISO-10303-21;\nHEADER;\nFILE_SCHEMA(('AUTOMOTIVE_DESIGN'));", "STEP"},
      {"ISO-10303-21;\nHEADER;\nFILE_SCHEMA(('IFC4'));", "IFC"},
      {"PK\x03\x04zip", "ZIP"},
      {"\r\n<!DOCTYPE html><title>404</title>", "HTML"},
      {"<?xml version='1.0'?><COLLADA>", "COLLADA"},
  };
  for (const auto& [content, name] : kinds) {
    const Result<Scene> other = load_text(content, "a.glb");
    EXPECT_REFUSED(other, kSceneFormat, name);
    EXPECT_FALSE(other.error().hint.empty()) << name;
  }
}

TEST(GltfContainer, GlbHeaderAndChunks) {
  const std::string good = triangle().glb();
  EXPECT_REFUSED(load_text(good.substr(0, 16)), kSceneFormat, "too short");
  EXPECT_REFUSED(load_text(good.substr(0, good.size() - 4)), kSceneFormat, "header says");
  EXPECT_REFUSED(load_text(make_glb(R"({"asset":{"version":"2.0"}})", "", 1)), kSceneFormat,
                 "version 1");
  std::string long_chunk = good;
  long_chunk.replace(12, 4, u32_bytes(0xfffffff0u));
  EXPECT_REFUSED(load_text(long_chunk), kSceneFormat, "chunk 0");
  std::string other_first = good;
  other_first.replace(16, 4, "ABCD");
  EXPECT_REFUSED(load_text(other_first), kSceneFormat, "not JSON");
}

// Exporters write lengths without padding, or count their own header.
TEST(GltfContainer, LengthsAFewBytesOffAreForgiven) {
  const std::string good = triangle().glb();
  const std::uint32_t json =
      static_cast<unsigned char>(good[12]) + 256u * static_cast<unsigned char>(good[13]);
  const std::size_t bin = 20 + json;
  for (const auto& [place, value] : {std::pair<std::size_t, std::size_t>{8, good.size() - 3},
                                     {8, good.size() + 8},
                                     {12, json - 2},
                                     {12, json + 8},
                                     {bin, 36 + 4},
                                     {bin, 36 - 4}}) {
    std::string off = good;
    off.replace(place, 4, u32_bytes(static_cast<std::uint32_t>(value)));
    const Result<Scene> scene = load_text(off);
    ASSERT_TRUE(scene) << place << " " << failure(scene);
    EXPECT_EQ(scene->triangles(), 1u);
    EXPECT_TRUE(has_warning(*scene, "GLB lengths a few bytes off")) << place;
    EXPECT_FALSE(load_text(off, "a.glb", true)) << place;
  }
  EXPECT_REFUSED(load_text(good.substr(0, good.size() - 1)), kSceneFormat, "header says");
}

TEST(GltfContainer, BytesAfterTheGlbAreIgnored) {
  const Result<Scene> scene = load_text(triangle().glb() + "more");
  ASSERT_TRUE(scene) << failure(scene);
  EXPECT_EQ(scene->triangles(), 1u);
}

TEST(GltfContainer, JsonNesting) {
  const std::string head = R"({"asset":{"version":"2.0"},"extras":)";
  const std::string deep = std::string(70, '[') + std::string(70, ']');
  EXPECT_REFUSED(load_text(head + deep + "}"), kSceneLimit, "64 levels");
  // Brackets inside a string do not nest, even after an escaped quote.
  EXPECT_TRUE(load_text(head + "\"\\\"" + std::string(70, '[') + "\"}").ok());
}

TEST(GltfContainer, JsonSyntax) {
  EXPECT_REFUSED(load_text(R"({"asset":)"), kSceneFormat, "syntax error");
  EXPECT_REFUSED(load_text("{\"asset\":{\"version\":\"2.0\"},\"x\":\"\xff\xfe\"}", "a.gltf", true),
                 kSceneFormat, "syntax error");
  EXPECT_REFUSED(load_text(R"({"asset":{"version":"2.0"},"x":1e999})", "a.gltf", true),
                 kSceneFormat, "number");
}

TEST(GltfContainer, NamesThatAreNotUtf8AndNumbersThatAreNotFiniteAreForgiven) {
  Builder builder = triangle();
  builder.doc["buffers"] = json::array({{{"byteLength", builder.bin.size()}}});
  const std::string text = builder.doc.dump();
  for (const std::string extra :
       {"\"x\":\"M\xfcller \\\" \xc3\xa4 \xed\xa0\x80\"", "\"x\":[NaN,-Infinity,Infinity,true]",
        "\"x\":{\"y\":1e999,\"z\":-2.5e3}"}) {
    const std::string glb = make_glb("{" + extra + "," + text.substr(1), builder.bin);
    const Result<Scene> scene = load_text(glb);
    ASSERT_TRUE(scene) << failure(scene);
    EXPECT_EQ(scene->triangles(), 1u);
    EXPECT_TRUE(has_warning(*scene, "not UTF-8")) << extra;
    EXPECT_FALSE(load_text(glb, "a.glb", true)) << extra;
  }
}

TEST(GltfContainer, AssetVersion) {
  EXPECT_REFUSED(load_text(R"({"scenes":[]})"), kSceneFormat, "asset");
  EXPECT_REFUSED(load_text(R"({"asset":[]})"), kSceneFormat, "asset");
  EXPECT_REFUSED(load_text(R"({"asset":{"version":"1.0"}})"), kSceneFormat, "1.0");
  EXPECT_REFUSED(load_text(R"({"asset":{"version":3}})"), kSceneFormat, "version");
  EXPECT_REFUSED(load_text(R"({"asset":{"version":2}})", "a.gltf", true), kSceneFormat, "version");
  EXPECT_TRUE(load_text(R"({"asset":{"version":2}})").ok());
  EXPECT_TRUE(load_text(R"({"asset":{"version":"2.0"}})").ok());
}

TEST(GltfContainer, DuplicateNames) {
  const std::string twice = R"({"asset":{"version":"1.0","version":"2.0"},"nodes":[{},{}]})";
  auto scene = load_text(twice);
  ASSERT_TRUE(scene) << failure(scene);
  EXPECT_TRUE(has_warning(*scene, "duplicate names in JSON"));
  const TempFolder folder;
  EXPECT_REFUSED(import_gltf(folder.write("scene.gltf", twice), Workers(), {.strict = true}),
                 kSceneFormat, "1 JSON objects name a property twice");
}

// Files of buildings have dozens of properties in each element.
TEST(GltfContainer, ExtrasCountAsNothing) {
  Builder builder = triangle();
  json many = json::array();
  for (int i = 0; i < 1000; ++i) many.push_back({{"deep", {1, 2, {{"extras", {3}}}}}});
  builder.doc["nodes"][0]["extras"] = {{"properties", many}, {"mirage", {{"phase", 0.5}}}};
  builder.doc["extras"] = many;
  builder.doc["meshes"][0]["extras"] = "text";
  auto scene = builder.load_strict();
  ASSERT_TRUE(scene) << failure(scene);
  EXPECT_EQ(scene->triangles(), 1u);
  // Seven million values outside of extras are too many; inside, they are not looked at.
  std::string values = "[0";
  for (int i = 0; i < 7'000'000; ++i) values += ",0";
  const std::string head = R"({"asset":{"version":"2.0"},)";
  EXPECT_REFUSED(load_text(head + "\"other\":" + values + "]}"), kSceneLimit, "values");
  EXPECT_TRUE(load_text(head + "\"extras\":{\"a\":" + values + "]},\"nodes\":[{}]}").ok());
}

TEST(GltfContainer, RequiredExtensions) {
  for (const char* name : {"KHR_materials_of_tomorrow", "VENDOR_thing"}) {
    Builder builder = triangle();
    builder.doc["extensionsRequired"] = json::array({name});
    EXPECT_REFUSED(builder.load_strict(), kSceneExtension, name);
    auto scene = builder.load();
    ASSERT_TRUE(scene) << failure(scene);
    EXPECT_TRUE(has_warning(*scene, "1 required extensions that are not supported ignored"));
    EXPECT_EQ(scene->triangles(), 1u);
    // It is the reason if nothing can be drawn.
    builder.doc["meshes"][0]["primitives"][0]["attributes"] = json::object();
    EXPECT_REFUSED(builder.load(), kSceneExtension, name);
  }
  Builder builder = triangle();
  builder.doc["extensionsRequired"] = {"KHR_texture_transform", "KHR_mesh_quantization"};
  builder.doc["extensionsUsed"] = {"VENDOR_thing", "KHR_mesh_quantization", "VENDOR_other"};
  auto scene = builder.load();
  ASSERT_TRUE(scene) << failure(scene);
  EXPECT_TRUE(has_warning(*scene, "VENDOR_thing, VENDOR_other"));
}

TEST(GltfContainer, Limits) {
  std::string nodes = R"({"asset":{"version":"2.0"},"nodes":[{})";
  for (int i = 0; i < 500'000; ++i) nodes += ",{}";
  // The time to read a list grows with its length, not with its square: that took a minute.
  const auto start = std::chrono::steady_clock::now();
  EXPECT_TRUE(load_text(nodes + "]}").ok());
  EXPECT_LT(std::chrono::steady_clock::now() - start, std::chrono::seconds(15));

  EXPECT_REFUSED(load_text(nodes + "]}", "scene.gltf", false, 600), kSceneLimit,
                 "500001 nodes, a scene of 600 MB may have 390625");

  Builder zeros;
  zeros.doc["accessors"] = {{{"componentType", 5126}, {"count", 2'000'000'000}, {"type", "VEC3"}}};
  zeros.mesh({{"POSITION", 0}});
  EXPECT_REFUSED(zeros.load(), kSceneLimit, "accessors[0]");

  // 40 meshes share one accessor of 300 000 vertices: 12 million once expanded.
  Builder many;
  std::vector<float> position(900'000);
  for (std::size_t i = 0; i < position.size(); ++i) position[i] = static_cast<float>(i % 7);
  const int shared = many.vec3(position);
  for (int i = 0; i < 40; ++i) many.mesh({{"POSITION", shared}});
  EXPECT_REFUSED(many.load(), kSceneLimit, "vertices");
}

class GltfUri : public ::testing::Test {
 protected:
  GltfUri() {
    Builder builder = triangle();
    bin_ = builder.bin;
    doc_ = builder.doc;
    fs::create_directory(folder_.path() / "scene");
    folder_.write("scene/good name.bin", bin_);
    folder_.write("outside.bin", bin_);
  }
  Result<Scene> load(const std::string& uri, bool strict = false) {
    doc_["buffers"] = json::array({{{"byteLength", bin_.size()}, {"uri", uri}}});
    return import_gltf(folder_.write("scene/scene.gltf", doc_.dump()), Workers(),
                       {.strict = strict});
  }
  /// Expects that it loads with this warning, but not when strict.
  void expect_forgiven(const std::string& uri, const std::string& warning) {
    auto scene = load(uri);
    ASSERT_TRUE(scene) << failure(scene);
    EXPECT_TRUE(has_warning(*scene, "1 " + warning)) << uri;
    EXPECT_REFUSED(load(uri, true), kSceneUri, "buffers[0]");
  }

  TempFolder folder_;
  std::string bin_;
  json doc_;
};

TEST_F(GltfUri, FilesInsideTheFolder) {
  EXPECT_TRUE(load("good%20name.bin", true).ok()) << failure(load("good%20name.bin", true));
  expect_forgiven("good name.bin", "URIs with spaces");
  expect_forgiven("../scene/good%20name.bin", "URIs with '..'");
  expect_forgiven("no/such/../%2e./good%20name.bin", "URIs with '..'");
  fs::create_directory(folder_.path() / "scene" / "sub");
  folder_.write("scene/sub/100%.bin", bin_);
  expect_forgiven("sub/100%.bin", "URIs with broken percent escapes");
  expect_forgiven("sub\\100%25.bin", "URIs with backslashes");
  fs::create_symlink("good name.bin", folder_.path() / "scene" / "link.bin");
  EXPECT_TRUE(load("link.bin").ok());
}

TEST_F(GltfUri, MissingAndShortFiles) {
  EXPECT_REFUSED(load("not_there.bin"), kSceneMissing, "not_there.bin");
  folder_.write("scene/short.bin", bin_.substr(0, 8));
  EXPECT_REFUSED(load("short.bin"), kSceneRange, "buffers[0].byteLength");
}

TEST_F(GltfUri, WhatLeavesTheFolder) {
  EXPECT_REFUSED(load("../outside.bin"), kSceneUri, "leaves the folder");
  EXPECT_REFUSED(load("%2e%2e/outside.bin"), kSceneUri, "leaves the folder");
  EXPECT_REFUSED(load("sub/../../outside.bin"), kSceneUri, "leaves the folder");
  EXPECT_REFUSED(load("..\\outside.bin"), kSceneUri, "leaves the folder");
  EXPECT_REFUSED(load("/etc/passwd"), kSceneUri, "absolute");
  EXPECT_REFUSED(load("http://example.invalid/a.bin"), kSceneUri, "only relative");
  EXPECT_REFUSED(load("file:///etc/passwd"), kSceneUri, "only relative");
  fs::create_symlink(folder_.path() / "outside.bin", folder_.path() / "scene" / "escape.bin");
  EXPECT_REFUSED(load("escape.bin"), kSceneUri, "leaves the folder");
}

TEST_F(GltfUri, PipesAndFolders) {
  ASSERT_EQ(mkfifo((folder_.path() / "scene" / "pipe.bin").c_str(), 0600), 0);
  EXPECT_REFUSED(load("pipe.bin"), kSceneUri, "not a regular file");
  EXPECT_REFUSED(load("."), kSceneUri, "not a regular file");
}

TEST_F(GltfUri, DataUris) {
  EXPECT_REFUSED(load("data:application/octet-stream;base64,@@@@"), kSceneUri, "base64");
  EXPECT_REFUSED(load("data:application/octet-stream;base64,AAAAA"), kSceneUri, "base64");
  EXPECT_REFUSED(load("data:application/octet-stream;base64,AAAA"), kSceneRange, "buffers[0]");
  EXPECT_REFUSED(load("data:nothing"), kSceneUri, "data URI");
  EXPECT_REFUSED(load("data:application/octet-stream,%zz"), kSceneUri, "percent");
  // Base64 in lines, or with the alphabet of URLs.
  for (const std::string& good :
       {std::string(20, 'A') + "\r\n" + std::string(28, 'A') + "\n", std::string(46, 'A') + "-_"}) {
    EXPECT_TRUE(load("data:;base64," + good).ok()) << failure(load("data:;base64," + good));
  }
  // 36 zero bytes load, although all corners coincide.
  EXPECT_TRUE(load("data:;base64," + std::string(48, 'A')).ok());
}

TEST(GltfReference, DanglingIndicesAreNamed) {
  struct Case {
    const char* pointer;
    json value;
    const char* part;
  };
  const std::vector<Case> cases = {
      {"/accessors/0/bufferView", 9, "accessors[0].bufferView = 9"},
      {"/accessors/0/bufferView", -1, "accessors[0].bufferView = -1"},
      {"/bufferViews/0/buffer", 1, "bufferViews[0].buffer"},
      {"/meshes/0/primitives/0/attributes/POSITION", 4, "attributes.POSITION = 4"},
      {"/meshes/0/primitives/0/material", 0, "primitives[0].material"},
      {"/meshes/0/primitives/0/indices", 7, "primitives[0].indices"},
      {"/nodes/0/mesh", 3, "nodes[0].mesh = 3"},
      {"/nodes/0/children", {5}, "nodes[0].children[0] = 5"},
      {"/nodes/0/skin", 0, "nodes[0].skin"},
      {"/scene", 2, "scene = 2"},
      {"/textures", {{{"source", 1}}}, "textures[0].source"},
      {"/textures", {{{"sampler", 1}}}, "textures[0].sampler"},
  };
  for (const Case& item : cases) {
    Builder builder = triangle();
    builder.doc[json::json_pointer(item.pointer)] = item.value;
    EXPECT_REFUSED(builder.load_strict(), kSceneReference, item.part);
  }
}

TEST(GltfReference, BufferWithoutContent) {
  Builder builder = triangle();
  builder.doc["buffers"] = json::array({{{"byteLength", 36}}});
  const TempFolder folder;
  EXPECT_REFUSED(import_gltf(folder.write("scene.gltf", builder.doc.dump())), kSceneReference,
                 "accessors[0]");
}

TEST(GltfRange, ElementsMustFit) {
  struct Case {
    const char* pointer;
    json value;
    const char* part;
  };
  const std::vector<Case> cases = {
      {"/bufferViews/0/byteLength", 40, "bufferViews[0] ends"},
      {"/bufferViews/0/byteOffset", 2147483647, "bufferViews[0] ends"},
      {"/bufferViews/0/byteStride", -4, "byteStride = -4"},
      {"/bufferViews/0/byteStride", 8, "byteStride 8"},
      {"/accessors/0/count", 4, "accessors[0] needs 48 bytes"},
      {"/accessors/0/count", 0, "count 0"},
      {"/accessors/0/count", 9223372036854775807, "accessors[0].count"},
      {"/accessors/0/byteOffset", 4, "accessors[0] needs"},
  };
  for (const Case& item : cases) {
    Builder builder = triangle();
    builder.doc[json::json_pointer(item.pointer)] = item.value;
    EXPECT_REFUSED(builder.load(), kSceneRange, item.part);
  }
}

TEST(GltfRange, StridesOutside4To252) {
  for (const int stride : {2, 13, 256}) {
    Builder builder = triangle();
    builder.doc["bufferViews"][0]["byteStride"] = stride;
    EXPECT_REFUSED(builder.load_strict(), kSceneFormat, "byteStride");
    EXPECT_REFUSED(builder.load(), kSceneRange, "accessors[0]");
  }
}

TEST(GltfRange, SparseAccessors) {
  auto sparse = [](const std::vector<std::uint16_t>& places, int component_type) {
    Builder builder = triangle();
    const int at = builder.view(places);
    const int values = builder.view(std::vector<float>(3 * places.size(), 5.0f));
    builder.doc["accessors"][0]["sparse"] = {
        {"count", places.size()},
        {"indices", {{"bufferView", at}, {"componentType", component_type}}},
        {"values", {{"bufferView", values}}}};
    return builder.load();
  };
  auto good = sparse({1}, 5123);
  ASSERT_TRUE(good) << failure(good);
  EXPECT_EQ(good->objects[0].mesh.vertices[1].position, glm::vec3(5));
  EXPECT_REFUSED(sparse({1, 1}, 5123), kSceneRange, "sparse index");
  EXPECT_REFUSED(sparse({3}, 5123), kSceneRange, "sparse index");
  EXPECT_REFUSED(sparse({0, 1, 2, 3}, 5123), kSceneRange, "count 4 of 3");
  EXPECT_REFUSED(sparse({0}, 5126), kSceneFormat, "component type");
}

TEST(GltfRange, WrongTypes) {
  struct Case {
    const char* pointer;
    json value;
  };
  const std::vector<Case> cases = {{"/nodes", json::object()},
                                   {"/nodes/0", 3},
                                   {"/nodes/0/mesh", "zero"},
                                   {"/nodes/0/mesh", 0.5},
                                   {"/nodes/0/translation", {1, 2}},
                                   {"/nodes/0/scale", {1, "a", 2}},
                                   {"/accessors/0/componentType", 5124},
                                   {"/accessors/0/type", "VEC7"},
                                   {"/meshes/0/primitives/0/mode", 11},
                                   {"/meshes/0/primitives/0/attributes", json::array()}};
  for (const Case& item : cases) {
    Builder builder = triangle();
    builder.doc[json::json_pointer(item.pointer)] = item.value;
    auto scene = builder.load_strict();
    ASSERT_FALSE(scene.ok()) << item.pointer;
    EXPECT_EQ(scene.error().id, ErrorId::kSceneFormat) << item.pointer << failure(scene);
  }
  Builder builder = triangle();
  builder.doc["nodes"][0]["name"] = 7;    // names have no meaning
  builder.doc["nodes"][0]["mesh"] = 0.0;  // an integer written as a float
  EXPECT_TRUE(builder.load().ok());
}

}  // namespace
}  // namespace mirage::test
