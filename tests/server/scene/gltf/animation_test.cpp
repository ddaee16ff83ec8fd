// Animations of files: moving nodes become one object per group, broken animations leave them at
// rest.
#include <cmath>
#include <limits>

#include "protocol/impostor/motion.h"
#include "tests/support/data_folder.h"
#include "tests/support/gltf_fixture.h"

namespace mirage::test {
namespace {

namespace fs = std::filesystem;

int scalars(Builder& b, const std::vector<float>& values) {
  return b.accessor(values, "SCALAR", 5126, 1);
}

/// One clip that drives `path` of `node`.
void animate(Builder& b, int node, const std::string& path, const std::vector<float>& times,
             int output, const std::string& interpolation = "LINEAR") {
  json sampler = {{"input", scalars(b, times)}, {"output", output}};
  sampler["interpolation"] = interpolation;
  const json channel = {{"sampler", 0}, {"target", {{"node", node}, {"path", path}}}};
  b.doc["animations"].push_back(
      {{"samplers", json::array({sampler})}, {"channels", json::array({channel})}});
}

/// The triangle, moved from x = 0 to x = 2 in a second.
Builder sliding() {
  Builder b = triangle();
  animate(b, 0, "translation", {0, 1}, b.vec3({0, 0, 0, 2, 0, 0}));
  return b;
}

std::vector<glm::vec3> posed(const SceneObject& object, double t) {
  std::vector<glm::vec3> out;
  pose_positions(object.mesh.vertices, *object.animation, t, out);
  return out;
}

TEST(GltfAnimation, ARigidNodeMovesItsMesh) {
  Builder b = sliding();
  b.doc["nodes"].push_back({{"children", {0}}, {"translation", {0, 5, 0}}, {"scale", {2, 2, 2}}});
  const Result<Scene> scene = b.load();
  ASSERT_TRUE(scene) << failure(scene);
  ASSERT_EQ(scene->objects.size(), 1u);
  ASSERT_NE(scene->objects[0].animation, nullptr);
  EXPECT_EQ(scene->objects[0].animation->clip_s, 1);
  const Similarity& world = scene->instances[0].world_from_object;
  EXPECT_EQ(world.position, glm::dvec3(0, 5, 0));  // the part that does not move
  EXPECT_EQ(world.scale, 2);
  EXPECT_NEAR(posed(scene->objects[0], 0.5)[0].x - posed(scene->objects[0], 0)[0].x, 1, 1e-6);
}

TEST(GltfAnimation, ConstantChannelsAreStaticAndSetThePose) {
  Builder b = triangle();
  animate(b, 0, "translation", {0, 1, 2}, b.vec3({3, 0, 0, 3, 0, 0, 3, 0, 0}));
  const Result<Scene> scene = b.load();
  ASSERT_TRUE(scene) << failure(scene);
  EXPECT_EQ(scene->objects[0].animation, nullptr);
  EXPECT_EQ(scene->instances[0].world_from_object.position.x, 3);
}

TEST(GltfAnimation, MirroredPartsKeepTheirFront) {
  Builder b = sliding();
  b.doc["nodes"][0]["scale"] = {-1, 1, 1};
  const Result<Scene> scene = b.load();
  ASSERT_TRUE(scene) << failure(scene);
  const SceneObject& object = scene->objects[0];
  std::vector<Vertex> v;
  pose_vertices(object.mesh.vertices, *object.animation, 0, v);
  const std::vector<std::uint32_t>& i = object.mesh.indices;
  const glm::vec3 face =
      glm::cross(v[i[1]].position - v[i[0]].position, v[i[2]].position - v[i[0]].position);
  EXPECT_GT(glm::dot(face, v[i[0]].normal), 0);
}

TEST(GltfAnimation, EqualMovingPartsAreOneObject) {
  Builder b = sliding();
  b.doc["nodes"].push_back({{"mesh", 0}});
  b.doc["nodes"].push_back({{"children", {1}}, {"translation", {9, 0, 0}}});
  json channel = b.doc["animations"][0]["channels"][0];
  channel["target"]["node"] = 1;
  b.doc["animations"][0]["channels"].push_back(channel);
  const Result<Scene> scene = b.load();
  ASSERT_TRUE(scene) << failure(scene);
  EXPECT_EQ(scene->objects.size(), 1u);
  ASSERT_EQ(scene->instances.size(), 2u);
}

TEST(GltfAnimation, OneSubtreeIsOneObject) {
  Builder b = sliding();
  b.doc["nodes"].push_back({{"mesh", 0}, {"translation", {0, 0, 1}}});
  b.doc["nodes"][0]["children"] = {1};
  const Result<Scene> scene = b.load();
  ASSERT_TRUE(scene) << failure(scene);
  ASSERT_EQ(scene->objects.size(), 1u);
  EXPECT_EQ(scene->instances.size(), 1u);
  EXPECT_EQ(posed(scene->objects[0], 1)[3], glm::vec3(2, 0, 1));
}

TEST(GltfAnimation, OfTwoClipsForOneNodeTheFirstPlays) {
  Builder b = sliding();
  animate(b, 0, "translation", {0, 5}, b.vec3({0, 0, 0, 9, 9, 9}));
  const Result<Scene> scene = b.load();
  ASSERT_TRUE(scene) << failure(scene);
  EXPECT_EQ(scene->objects[0].animation->clip_s, 1);
  EXPECT_TRUE(has_warning(*scene, "clips that ?clip=NAME plays left out"));
}

// Exporters write a bind pose as the first clip.
TEST(GltfAnimation, AFirstClipThatIsAPoseEndsNoOther) {
  for (const std::vector<float>& times : {std::vector<float>{0}, std::vector<float>{0, 1}}) {
    Builder b = triangle();
    const std::vector<float> still(3 * times.size(), 7.0f);
    animate(b, 0, "translation", times, b.vec3(still));
    animate(b, 0, "translation", {0, 1}, b.vec3({0, 0, 0, 2, 0, 0}));
    const Result<Scene> scene = b.load();
    ASSERT_TRUE(scene) << failure(scene);
    ASSERT_NE(scene->objects[0].animation, nullptr);
    EXPECT_NEAR(posed(scene->objects[0], 0.5)[0].x - posed(scene->objects[0], 0)[0].x, 1, 1e-6);
    EXPECT_TRUE(scene->warnings.empty());
  }
}

TEST(GltfAnimation, AClipWithoutANameOfItsOwnIsCalledByItsPlace) {
  Builder b = sliding();
  for (const char* name : {"walk", "walk", ""}) {
    animate(b, 0, "translation", {0, 1}, b.vec3({0, 0, 0, 0, 4, 0}));
    b.doc["animations"].back()["name"] = name;
  }
  const Result<Scene> scene = b.load();
  ASSERT_TRUE(scene) << failure(scene);
  EXPECT_EQ(scene->choices.clips, (std::vector<std::string>{"0", "walk", "2", "3"}));
}

TEST(GltfAnimation, AClipCanBeChosen) {
  Builder b = sliding();
  animate(b, 0, "translation", {0, 1}, b.vec3({0, 0, 0, 0, 4, 0}));
  b.doc["animations"][0]["name"] = "slide & stop";
  b.doc["animations"][1]["name"] = "rise";
  const TempFolder folder;
  const std::string file = folder.write("scene.glb", b.glb());
  const auto moved = [&](const std::string& query) {
    const Result<Scene> scene = import_gltf_spec(file + query);
    EXPECT_TRUE(scene) << failure(scene);
    if (!scene) return glm::vec3(0);
    return posed(scene->objects[0], 0.5)[0] - posed(scene->objects[0], 0)[0];
  };
  const auto choices = [&](const std::string& query) {
    return import_gltf_spec(file + query).take().choices;
  };
  EXPECT_EQ(choices("").clips, (std::vector<std::string>{"slide & stop", "rise"}));
  EXPECT_EQ(choices("").shown, SceneChoice{});
  EXPECT_EQ(choices("?clip=1").clips.size(), 2u) << "all of the file";
  EXPECT_EQ(choices("?clip=1").shown.clip, "rise") << "by its name";
  EXPECT_NEAR(moved("").x, 1, 1e-6);
  EXPECT_NEAR(moved("?clip=slide & stop").x, 1, 1e-6);
  EXPECT_NEAR(moved("?clip=rise").y, 2, 1e-6);
  EXPECT_NEAR(moved("?clip=1").y, 2, 1e-6);
  const Result<Scene> unknown = import_gltf_spec(file + "?clip=fall");
  EXPECT_REFUSED(unknown, kUsage, "no clip 'fall'");
  EXPECT_EQ(unknown.error().hint, "its clips: slide & stop, rise");
  EXPECT_REFUSED(import_gltf_spec(file + "?clip=2"), kUsage, "no clip '2'");
  EXPECT_REFUSED(import_gltf_spec(file + "?clip=rise&variant=red"), kUsage, "no variant 'red'");
  EXPECT_REFUSED(import_gltf_spec(file + "?clip="), kUsage, "?clip=NAME");
}

// A square of two triangles without normals becomes a roof: each face turns.
/// A channel to a pointer instead of a node and path.
void point_at(Builder& b, const std::string& pointer) {
  b.doc["animations"].back()["channels"][0]["target"] = {
      {"path", "pointer"}, {"extensions", {{"KHR_animation_pointer", {{"pointer", pointer}}}}}};
}

TEST(GltfAnimation, VisibilityIsAnimatedThroughAPointer) {
  Builder b = triangle();
  b.doc["extensionsUsed"] = {"KHR_animation_pointer", "KHR_node_visibility"};
  b.doc["nodes"][0]["extensions"] = {{"KHR_node_visibility", {{"visible", false}}}};
  b.doc["nodes"][0]["scale"] = {2, 2, 2};
  const std::vector<std::uint8_t> shown = {0, 1, 0};
  animate(b, 0, "", {0, 1, 2}, b.accessor(shown, "SCALAR", 5121, 1));
  point_at(b, "/nodes/0/extensions/KHR_node_visibility/visible");
  const Result<Scene> scene = b.load();
  ASSERT_TRUE(scene) << failure(scene);
  EXPECT_TRUE(scene->warnings.empty());
  ASSERT_EQ(scene->objects.size(), 1u);
  ASSERT_NE(scene->objects[0].animation, nullptr);
  const auto width = [&](double t) {
    const std::vector<glm::vec3> corners = posed(scene->objects[0], t);
    return glm::distance(corners[0], corners[1]);
  };
  EXPECT_EQ(width(0.5), 0);
  EXPECT_EQ(width(1.5), 2);
}

TEST(GltfAnimation, PointersToOtherPropertiesOfNodesWork) {
  Builder b = sliding();
  point_at(b, "/nodes/0/translation");
  const Result<Scene> scene = b.load();
  ASSERT_TRUE(scene) << failure(scene);
  ASSERT_NE(scene->objects[0].animation, nullptr);
  EXPECT_NEAR(posed(scene->objects[0], 0.5)[0].x - posed(scene->objects[0], 0)[0].x, 1, 1e-6);
  for (const char* pointer : {"/materials/0/pbrMetallicRoughness/baseColorFactor", "/nodes/7/scale",
                              "/nodes/-1/scale", "/nodes/", "/nodes/0x/scale", ""}) {
    point_at(b, pointer);
    const Result<Scene> still = b.load();
    ASSERT_TRUE(still) << pointer << failure(still);
    EXPECT_EQ(still->objects[0].animation, nullptr) << pointer;
    EXPECT_EQ(still->warnings.size(), 1u) << pointer;
  }
}

TEST(GltfAnimation, MorphedFacesWithoutNormalsTurn) {
  for (const bool mirrored : {false, true}) {
    Builder b;
    b.mesh({{"POSITION", b.vec3({0, 0, 0, 1, 0, 0, 1, 1, 0, 0, 1, 0})}},
           b.indices({0, 1, 2, 0, 2, 3}));
    b.primitive()["targets"] = {{{"POSITION", b.vec3({0, 0, 0, 0, 0, 1, 0, 0, 0, 0, 0, 2})}}};
    if (mirrored) b.doc["nodes"][0]["scale"] = {-1, 1, 1};
    animate(b, 0, "weights", {0, 1}, scalars(b, {0, 1}));
    const Result<Scene> scene = b.load();
    ASSERT_TRUE(scene) << failure(scene);
    const SceneObject& object = scene->objects[0];
    ASSERT_NE(object.animation, nullptr);
    for (const double t : {0.0, 0.5, 0.999999}) {
      std::vector<Vertex> out;
      pose_vertices(object.mesh.vertices, *object.animation, t, out);
      for (std::size_t at = 0; at < object.mesh.indices.size(); at += 3) {
        const Vertex* v[3];
        for (std::size_t c = 0; c < 3; ++c) v[c] = &out[object.mesh.indices[at + c]];
        const glm::vec3 face = glm::normalize(
            glm::cross(v[1]->position - v[0]->position, v[2]->position - v[0]->position));
        for (const Vertex* corner : v) {
          EXPECT_NEAR(std::abs(glm::dot(face, corner->normal)), 1, 1e-4) << t << mirrored;
          EXPECT_GT(corner->normal.z, 0) << "the side that showed at rest";
        }
      }
    }
  }
}

TEST(GltfAnimation, MorphsOfCopiesAreOffset) {
  Builder b = triangle();
  b.primitive()["targets"] = json::array({{{"POSITION", b.vec3({0, 0, 1, 0, 0, 0, 0, 0, 1})}}});
  animate(b, 0, "weights", {0, 2}, scalars(b, {0, 1}));
  b.doc["nodes"][0]["extensions"]["EXT_mesh_gpu_instancing"]["attributes"]["TRANSLATION"] =
      b.vec3({0, 0, 0, 5, 0, 0, 9, 0, 0});
  b.doc["extensionsUsed"] = {"EXT_mesh_gpu_instancing"};
  const Result<Scene> scene = b.load();
  ASSERT_TRUE(scene) << failure(scene);
  ASSERT_EQ(scene->objects.size(), 1u);
  ASSERT_EQ(scene->instances.size(), 3u);
  EXPECT_NE(scene->instances[1].clip_offset_s, scene->instances[2].clip_offset_s);
  EXPECT_NEAR(posed(scene->objects[0], 1)[0].z, 0.5, 1e-6);
  EXPECT_EQ(posed(scene->objects[0], 1)[1].z, 0);
}

TEST(GltfAnimation, ThePhaseOfANodeIsItsOffset) {
  Builder b = sliding();
  b.doc["nodes"][0]["extras"]["mirage"]["phase"] = 0.25;
  const Result<Scene> scene = b.load();
  ASSERT_TRUE(scene) << failure(scene);
  EXPECT_EQ(scene->instances[0].clip_offset_s, 0.25f);
}

TEST(GltfAnimation, SkinsBendBetweenJoints) {
  Builder b = triangle();
  b.primitive()["attributes"]["JOINTS_0"] =
      b.accessor(std::vector<std::uint8_t>{0, 0, 0, 0, 0, 1, 0, 0, 1, 0, 0, 0}, "VEC4", 5121, 4);
  b.primitive()["attributes"]["WEIGHTS_0"] = b.vec4({1, 0, 0, 0, 1, 1, 0, 0, 2, 0, 0, 0});
  b.doc["nodes"][0]["skin"] = 0;
  b.doc["nodes"].push_back({{"children", {2}}});
  b.doc["nodes"].push_back(json::object());
  b.doc["skins"] = json::array({{{"joints", {1, 2}}}});
  animate(b, 2, "translation", {0, 1}, b.vec3({0, 0, 0, 0, 0, 4}));
  const Result<Scene> scene = b.load();
  ASSERT_TRUE(scene) << failure(scene);
  const std::vector<glm::vec3> p = posed(scene->objects[0], 0.999999);
  EXPECT_NEAR(p[0].z, 0, 1e-5);
  EXPECT_NEAR(p[1].z, 2, 1e-4);  // half and half, although the weights add up to 2
  EXPECT_NEAR(p[2].z, 4, 1e-4);
}

TEST(GltfAnimation, BrokenAnimationsLeaveTheObjectAtRest) {
  const float nan = std::numeric_limits<float>::quiet_NaN();
  const auto warned = [](Builder b) {
    const Result<Scene> scene = b.load();
    EXPECT_TRUE(scene) << failure(scene);
    if (!scene) return false;
    EXPECT_EQ(scene->objects.size(), 1u);
    EXPECT_EQ(scene->objects[0].animation, nullptr);
    return has_warning(*scene, "ignored") || has_warning(*scene, "left at rest");
  };
  const auto with = [&](std::vector<float> times, std::vector<float> values, const char* path) {
    Builder b = triangle();
    const int output = std::string(path) == "rotation" ? b.vec4(values) : b.vec3(values);
    animate(b, 0, path, times, output);
    return warned(b);
  };
  EXPECT_TRUE(with({0, 0}, {0, 0, 0, 1, 0, 0}, "translation")) << "times do not rise";
  EXPECT_TRUE(with({0, nan}, {0, 0, 0, 1, 0, 0}, "translation"));
  EXPECT_TRUE(with({-1, 1}, {0, 0, 0, 1, 0, 0}, "translation"));
  EXPECT_TRUE(with({0, 1}, {0, 0, 0, nan, 0, 0}, "translation"));
  EXPECT_TRUE(with({0, 1}, {0, 0, 0}, "translation")) << "one value for two times";
  EXPECT_TRUE(with({0, 1}, {0, 0, 0, 1, 0, 0, 0, 0}, "rotation")) << "no length";
  EXPECT_TRUE(with({0, 1}, {0, 0, 0, 1, 0, 0}, "weights")) << "no targets";
  EXPECT_TRUE(with({0, 1}, {0, 0, 0, 1, 0, 0}, "colour"));
  EXPECT_TRUE(with({0, 1}, {0, 0, 0, 1e30f, 0, 0}, "scale"));
  for (const char* text :
       {R"(7)", R"([7])", R"([{"channels": 1, "samplers": []}])",
        R"([{"channels": [{}], "samplers": [{}]}])",
        R"([{"channels": [{"sampler": 0, "target": {"node": 99, "path": "scale"}}],
            "samplers": [{"input": 0, "output": 0}]}])",
        R"([{"channels": [{"sampler": 0, "target": {"node": 0, "path": "scale"}}],
            "samplers": [{"input": -1, "output": 1e99}]}])"}) {
    Builder b = triangle();
    b.doc["animations"] = json::parse(text);
    const Result<Scene> scene = b.load();
    ASSERT_TRUE(scene) << text << failure(scene);
    EXPECT_EQ(scene->objects[0].animation, nullptr) << text;
  }
}

class SharedAsset : public ::testing::Test {
 protected:
  static Result<Scene> load(const std::string& name) {
    return import_gltf((data_folder() / "assets" / name).string());
  }
  static void expect(const std::string& name, std::size_t objects, std::size_t moving,
                     std::size_t instances) {
    const Result<Scene> scene = load(name);
    ASSERT_TRUE(scene) << failure(scene);
    EXPECT_EQ(scene->objects.size(), objects) << name;
    EXPECT_EQ(scene->instances.size(), instances) << name;
    std::size_t count = 0;
    for (const SceneObject& object : scene->objects) count += object.animation != nullptr;
    EXPECT_EQ(count, moving) << name;
  }
};

TEST_F(SharedAsset, Fox) { expect("features/fox_skinned.glb", 1, 1, 1); }
TEST_F(SharedAsset, DeskFanIsOneSkeleton) { expect("objects/desk_fan_skinned.glb", 1, 1, 1); }
TEST_F(SharedAsset, TruckSharesItsWheels) { expect("features/milk_truck_animated.glb", 2, 1, 3); }
TEST_F(SharedAsset, MorphStressTest) { expect("features/morph_stress_test.glb", 1, 1, 1); }
TEST_F(SharedAsset, AxeHasTargetsButNoKeys) { expect("objects/frost_axe_morph.glb", 2, 0, 2); }
TEST_F(SharedAsset, InterpolationTestMovesNineCubes) {
  expect("features/interpolation_test/interpolation_test.gltf", 10, 9, 10);
}

}  // namespace
}  // namespace mirage::test
