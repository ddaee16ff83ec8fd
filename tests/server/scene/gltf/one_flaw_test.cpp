// One flaw: breaks one thing in a good file, in many ways and places, and expects that all that has
// nothing to do with it is still drawn.
#include <algorithm>
#include <chrono>
#include <functional>
#include <optional>
#include <set>

#include "tests/support/gltf_fixture.h"
#include "tests/support/png_builder.h"

namespace mirage::test {
namespace {

constexpr double kMaxSeconds = 5;

/// Two triangles that share nothing but the buffer. They are nodes 0 and 1.
const char* const kWitnesses[] = {"first", "second"};

/// A file that uses most of glTF: images both ways, a skin, morphs, sparse values, copies, lights,
/// a camera, variants and two clips.
Builder rich_file() {
  Builder b;
  for (const char* name : kWitnesses) {
    b.mesh({{"POSITION", b.vec3({0, 0, 0, 1, 0, 0, 0, 1, 0})}});
    b.doc["meshes"].back()["name"] = name;
  }
  const std::string png = make_png(2, 2, 8, 2, "abcdefghijkl");
  const int pixels = b.view(std::vector<char>(png.begin(), png.end()));
  b.doc["images"] = {{{"bufferView", pixels}, {"mimeType", "image/png"}}};
  b.doc["samplers"] = {{{"magFilter", 9729}, {"wrapS", 10497}}};
  b.doc["textures"] = {{{"source", 0}, {"sampler", 0}}};
  const json texture = {{"index", 0},
                        {"texCoord", 0},
                        {"extensions", {{"KHR_texture_transform", {{"scale", {2, 2}}}}}}};
  b.doc["materials"] = {{{"name", "painted"},
                         {"pbrMetallicRoughness",
                          {{"baseColorTexture", texture}, {"baseColorFactor", {1, .5, .5, 1}}}},
                         {"normalTexture", {{"index", 0}, {"scale", 0.5}}},
                         {"alphaMode", "MASK"},
                         {"alphaCutoff", 0.25},
                         {"extensions", {{"KHR_materials_clearcoat", {{"clearcoatFactor", 1}}}}}},
                        {{"doubleSided", true}}};
  const std::vector<float> square = {0, 0, 0, 1, 0, 0, 1, 1, 0, 0, 1, 0};
  const std::vector<std::uint16_t> corners = {0, 1, 2, 0, 2, 3};
  b.mesh({{"POSITION", b.vec3(square)},
          {"NORMAL", b.vec3({0, 0, 1, 0, 0, 1, 0, 0, 1, 0, 0, 1})},
          {"TEXCOORD_0", b.vec2({0, 0, 1, 0, 1, 1, 0, 1})},
          {"COLOR_0", b.vec4(std::vector<float>(16, 1.0f))}},
         b.indices(corners));
  json& painted = b.doc["meshes"].back()["primitives"][0];
  painted["material"] = 0;
  painted["extensions"]["KHR_materials_variants"]["mappings"] = {
      {{"material", 1}, {"variants", {0}}}};
  b.doc["extensions"]["KHR_materials_variants"]["variants"] = {{{"name", "bare"}}};

  b.mesh({{"POSITION", b.vec3(square)}}, b.indices(corners));  // morphs
  b.doc["meshes"].back()["weights"] = {0.5};
  const int delta = b.vec3(std::vector<float>(12, 0.5f));
  const int place = b.view(std::vector<std::uint16_t>{1});
  const int value = b.view(std::vector<float>{0, 0, 1});
  b.doc["accessors"][static_cast<std::size_t>(delta)]["sparse"] = {
      {"count", 1},
      {"indices", {{"bufferView", place}, {"componentType", 5123}}},
      {"values", {{"bufferView", value}}}};
  b.doc["meshes"].back()["primitives"][0]["targets"] = {{{"POSITION", delta}}};
  const int morphing = static_cast<int>(b.doc["nodes"].size()) - 1;

  const std::vector<std::uint8_t> joints(16, 0);  // a skin
  std::vector<float> weights;
  for (int i = 0; i < 4; ++i) weights.insert(weights.end(), {1, 0, 0, 0});
  b.mesh({{"POSITION", b.vec3(square)},
          {"JOINTS_0", b.accessor(joints, "VEC4", 5121, 4)},
          {"WEIGHTS_0", b.vec4(weights)}},
         b.indices(corners));
  const int joint = static_cast<int>(b.doc["nodes"].size());
  std::vector<float> bind(16, 0);
  for (std::size_t i = 0; i < 16; i += 5) bind[i] = 1;
  b.doc["skins"] = {{{"joints", {joint}},
                     {"skeleton", joint},
                     {"inverseBindMatrices", b.accessor(bind, "MAT4", 5126, 16)}}};
  b.doc["nodes"].back()["skin"] = 0;
  b.doc["nodes"].push_back({{"translation", {0, 1, 0}}, {"children", json::array()}});

  b.mesh({{"POSITION", b.vec3(square)}}, b.indices(corners));  // copies
  b.doc["nodes"].back()["extensions"]["EXT_mesh_gpu_instancing"]["attributes"] = {
      {"TRANSLATION", b.vec3({1, 0, 0, 2, 0, 0})}, {"SCALE", b.vec3({1, 1, 1, 2, 2, 2})}};

  b.doc["cameras"] = {{{"type", "perspective"}, {"perspective", {{"yfov", 0.8}, {"znear", 0.1}}}}};
  b.doc["nodes"].push_back(
      {{"camera", 0}, {"matrix", {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 5, 1}}});
  b.doc["extensions"]["KHR_lights_punctual"]["lights"] = {
      {{"type", "spot"}, {"intensity", 5}, {"spot", {{"innerConeAngle", 0.1}}}}};
  b.doc["nodes"].push_back({{"extensions", {{"KHR_lights_punctual", {{"light", 0}}}}},
                            {"rotation", {0, 0, 0, 1}},
                            {"scale", {1, 1, 1}}});
  const int times = b.accessor(std::vector<float>{0, 1}, "SCALAR", 5126, 1);
  const int moves = b.vec3({0, 0, 0, 0, 1, 0});
  const int amounts = b.accessor(std::vector<float>{0, 1}, "SCALAR", 5126, 1);
  b.doc["animations"] = {
      {{"name", "sway"},
       {"channels", {{{"sampler", 0}, {"target", {{"node", joint}, {"path", "translation"}}}}}},
       {"samplers", {{{"input", times}, {"output", moves}, {"interpolation", "LINEAR"}}}}},
      {{"channels", {{{"sampler", 0}, {"target", {{"node", morphing}, {"path", "weights"}}}}}},
       {"samplers", {{{"input", times}, {"output", amounts}}}}}};
  json roots = json::array();
  for (std::size_t i = 0; i < b.doc["nodes"].size(); ++i) roots.push_back(i);
  b.doc["scenes"] = {{{"nodes", roots}}};
  b.doc["scene"] = 0;
  b.doc["buffers"] = json::array({{{"byteLength", b.bin.size()}}});
  return b;
}

using Pointer = json::json_pointer;

void list_places(const json& at, const Pointer& here, std::vector<Pointer>& out) {
  if (!here.empty()) out.push_back(here);
  if (at.is_object()) {
    for (const auto& [key, value] : at.items()) list_places(value, here / key, out);
  } else if (at.is_array()) {
    for (std::size_t i = 0; i < at.size(); ++i) list_places(at[i], here / i, out);
  }
}

/// Breaks one place; false if there is nothing to break in this way.
using Flaw = std::function<bool(json& doc, const Pointer& place)>;

std::vector<Flaw> flaws() {
  std::vector<Flaw> out;
  const auto becomes = [&](const json& value) {
    out.push_back([value](json& doc, const Pointer& place) {
      if (doc[place] == value) return false;
      doc[place] = value;
      return true;
    });
  };
  for (const json& value :
       {json(nullptr), json(-1), json(0), json(1), json(7), json(0.5), json(-2.5), json(1e9),
        json(4294967296), json(1e300), json(""), json("text"), json(true), json::array(),
        json::object(), json::array({nullptr}), json::array({-1, 0.5, "x"}),
        json::object({{"a", 1}})}) {
    becomes(value);
  }
  out.push_back([](json& doc, const Pointer& place) {  // is gone; in a list, the rest moves up
    json& parent = doc[place.parent_pointer()];
    if (!parent.is_object()) return false;
    parent.erase(place.back());
    return true;
  });
  out.push_back([](json& doc, const Pointer& place) {  // has half of its elements, or a third more
    json& list = doc[place];
    if (!list.is_array() || list.size() < 2) return false;
    list.erase(list.begin() + static_cast<std::ptrdiff_t>(list.size() / 2), list.end());
    return true;
  });
  return out;
}

/// True if the flaw is in what the witness is made of. Its chain is all at the same place of the
/// lists.
bool touches(const Pointer& place, std::size_t witness) {
  const std::string text = place.to_string() + "/";
  const std::string index = std::to_string(witness);
  for (const char* list :
       {"/nodes/", "/meshes/", "/accessors/", "/bufferViews/", "/scenes/0/nodes/"}) {
    if (text.starts_with(list + index + "/")) return true;
  }
  return false;
}

/// True if nothing need be left: the flaw is in what everything is made of.
bool is_vital(const Pointer& place) {
  static const std::set<std::string> kWhole = {"/nodes",       "/meshes",   "/accessors",
                                               "/bufferViews", "/scenes/0", "/scenes/0/nodes"};
  const std::string text = place.to_string();
  return text.starts_with("/asset") || text.starts_with("/buffers") || kWhole.count(text) != 0;
}

bool draws(const Scene& scene, const std::string& name) {
  return std::any_of(scene.instances.begin(), scene.instances.end(),
                     [&](const Instance& i) { return scene.objects[i.object].name == name; });
}

TEST(GltfOneFlaw, TheFileIsSound) {
  const Result<Scene> scene = rich_file().load_strict();
  ASSERT_TRUE(scene) << failure(scene);
  EXPECT_TRUE(scene->warnings.empty()) << scene->warnings.front();
  for (const char* name : kWitnesses) EXPECT_TRUE(draws(*scene, name)) << name;
}

TEST(GltfOneFlaw, TheRestIsDrawn) {
  const Builder good = rich_file();
  std::vector<Pointer> places;
  list_places(good.doc, Pointer(), places);
  EXPECT_GE(places.size(), 200u);
  const std::vector<Flaw> ways = flaws();
  const TempFolder folder;
  int files = 0, refused = 0, warned = 0;
  for (const Pointer& place : places) {
    for (std::size_t way = 0; way < ways.size(); ++way) {
      Builder broken = good;
      if (!ways[way](broken.doc, place)) continue;
      SCOPED_TRACE(place.to_string() + ", way " + std::to_string(way));
      const auto start = std::chrono::steady_clock::now();
      const Result<Scene> scene = import_gltf(folder.write("scene.glb", broken.glb()));
      const std::chrono::duration<double> took = std::chrono::steady_clock::now() - start;
      EXPECT_LT(took.count(), kMaxSeconds);
      ++files;
      if (!scene) {
        ++refused;
        EXPECT_TRUE(is_vital(place)) << failure(scene);
        continue;
      }
      warned += scene->warnings.empty() ? 0 : 1;
      if (is_vital(place)) continue;
      for (std::size_t i = 0; i < std::size(kWitnesses); ++i) {
        if (touches(place, i)) continue;
        EXPECT_TRUE(draws(*scene, kWitnesses[i])) << kWitnesses[i];
      }
    }
  }
  std::printf("[ FIGURES  ] %zu places, %d files: %d refused, %d with a warning\n", places.size(),
              files, refused, warned);
}

}  // namespace
}  // namespace mirage::test
