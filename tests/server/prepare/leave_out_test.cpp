// Leave out: values that are neutral, texel by texel, and others that only look so; the table of
// rules.
#include <gtest/gtest.h>

#include <fstream>
#include <iterator>
#include <set>
#include <string>

#include "server/prove/left_out.h"
#include "tests/gl/need_scenes.h"

namespace mirage::test {
namespace {

bool finds(const Change& change, NeedRule rule) {
  Scene scene = ball_scene();
  change(scene);
  const LeftOutOfScene found = leave_out_unneeded(scene);
  for (const LeftOut& one : found.materials[0]) {
    if (one.rule == rule) return true;
  }
  // Tangents and coordinates of the ball are always unread.
  std::size_t attributes = 0;
  for (const LeftOut& one : found.objects[0]) attributes += one.rule == rule;
  return attributes > 2;
}

TEST(ServerLeaveOut, TheTableHasEveryRuleOnceAndSaysWhatBecameOfIt) {
  std::set<std::string_view> names;
  int number = 0;
  for (const NeedRuleInfo& rule : need_rules()) {
    EXPECT_EQ(static_cast<int>(rule.rule), ++number);
    EXPECT_EQ(&need_rule(rule.rule), &rule);
    names.insert(rule.name);
    for (const std::string_view text : {rule.name, rule.detection, rule.left_out, rule.saving}) {
      EXPECT_FALSE(text.empty()) << "rule " << number;
    }
    const bool applied = rule.state == RuleState::kApplied;
    EXPECT_EQ(rule.where.empty(), !applied) << "rule " << number;
    EXPECT_FALSE(rule.proof.empty()) << "rule " << number;
  }
  EXPECT_EQ(number, 29);
  EXPECT_EQ(names.size(), kNeedRules);
}

TEST(ServerLeaveOut, TheDocumentIsTheTable) {
  std::ifstream file(MIRAGE_SOURCE_DIR "/docs/NEEDS.md");
  const std::string text{std::istreambuf_iterator<char>(file), {}};
  for (const NeedRuleInfo& r : need_rules()) {
    std::string row = "| " + std::to_string(static_cast<int>(r.rule)) + " ";
    const std::string_view state = r.state == RuleState::kApplied ? "applied" : "dropped";
    const std::string_view where = r.where.empty() ? "–" : r.where;
    for (const std::string_view cell :
         {r.name, r.detection, r.left_out, state, where, r.proof, r.saving}) {
      row += "| " + std::string(cell) + " ";
    }
    EXPECT_NE(text.find(row + "|\n"), std::string::npos) << row;
  }
}

TEST(ServerLeaveOut, EqualObjectsAreOne) {
  const Change again = [](Scene& s) {
    s.objects[0].mesh.vertices[3].position.x = 0;
    s.objects.push_back(s.objects[0]);
    s.objects.push_back(s.objects[0]);
    s.objects[1].mesh.vertices[3].position.x = -0.0f;  // the same place
    s.objects[2].mesh.vertices[7].position.x += 1e-6f;
    s.instances.resize(3);
    for (std::uint32_t i : {1u, 2u}) {
      s.instances[i].object = i;
      s.instances[i].world_from_object.position.x = 10 * i;
    }
  };
  const auto scene = prepared({again});
  EXPECT_EQ(scene->left_out.equal_objects, 1u);
  ASSERT_EQ(scene->scene.objects.size(), 2u);
  EXPECT_EQ(scene->scene.instances[1].object, 0u);
  EXPECT_EQ(scene->scene.instances[2].object, 1u) << "one vertex is another";
}

TEST(ServerLeaveOut, NeutralIsFound) {
  for (const NamedChange& one : neutral_changes()) {
    if (one.rule == NeedRule::kAttributes || std::string(one.name) == "an image nobody uses")
      continue;
    EXPECT_TRUE(finds(one.change, one.rule)) << one.name;
  }
}

TEST(ServerLeaveOut, NearlyNeutralIsNot) {
  for (const NeededChange& one : needed_changes()) {
    EXPECT_FALSE(finds(one.change, one.rule)) << one.name;
  }
  // Two maps share one channel of an image; each reads its own.
  const auto shared = [](glm::u8vec4 value) {
    return [value](Scene& s) {
      with_map(&Material::metal_rough_map, solid_image(value, false))(s);
      s.materials[0].occlusion_map = s.materials[0].metal_rough_map;
    };
  };
  for (const glm::u8vec4& value : {glm::u8vec4(255, 9, 9, 255), glm::u8vec4(9, 255, 255, 255)}) {
    Scene scene = ball_scene();
    shared(value)(scene);
    leave_out_unneeded(scene);
    EXPECT_EQ(scene.materials[0].occlusion_map.present(), value.r != 255);
    EXPECT_EQ(scene.materials[0].metal_rough_map.present(), value.r == 255);
    EXPECT_EQ(scene.images.size(), 1u) << "the other map still reads it";
  }
}

TEST(ServerLeaveOut, FactorsDecideWhichChannelsMatter) {
  const Change no_metal = [](Scene& s) {
    with_map(&Material::metal_rough_map, solid_image({7, 255, 7, 255}, false))(s);
    s.materials[0].metallic = 0;
  };
  EXPECT_TRUE(finds(no_metal, NeedRule::kMaps));
  const Change metal = [&](Scene& s) {
    no_metal(s);
    s.materials[0].metallic = 0.1f;
  };
  EXPECT_FALSE(finds(metal, NeedRule::kMaps));
}

TEST(ServerLeaveOut, AlphaIsOfVerticesTexelsAndFactor) {
  const Change blend = [](Scene& s) { s.materials[0].alpha_mode = AlphaMode::kBlend; };
  EXPECT_TRUE(finds(blend, NeedRule::kBlending));
  EXPECT_FALSE(finds(
      [&](Scene& s) {
        blend(s);
        s.objects[0].mesh.vertices[5].color.a = 65534;
      },
      NeedRule::kBlending));
  EXPECT_FALSE(finds(
      [&](Scene& s) {
        blend(s);
        with_map(&Material::base_color_map, small_image({9, 9, 9, 255}, {9, 9, 9, 254}, true))(s);
      },
      NeedRule::kBlending));
  const auto masked = [](float alpha) {
    return [alpha](Scene& s) {
      s.materials[0].alpha_mode = AlphaMode::kMask;
      s.materials[0].base_color.a = alpha;
    };
  };
  EXPECT_TRUE(finds(masked(0.5f), NeedRule::kBlending));
  EXPECT_FALSE(finds(masked(0.499f), NeedRule::kBlending)) << "it shows nothing at all";
}

TEST(ServerLeaveOut, ImagesMoveUpAndMapsFollow) {
  Scene scene = ball_scene();
  with_map(&Material::occlusion_map, solid_image({255, 255, 255, 255}, false))(scene);
  with_map(&Material::base_color_map, solid_image({10, 20, 30, 255}, true))(scene);
  leave_out_unneeded(scene);
  ASSERT_EQ(scene.images.size(), 1u);
  EXPECT_EQ(scene.images[0].rgba[0], 10);
  EXPECT_EQ(scene.materials[0].base_color_map.image, 0);
  EXPECT_FALSE(scene.materials[0].occlusion_map.present());
}

TEST(ServerLeaveOut, BlackAndDistantLightsAreToldByObject) {
  const Change lights = [](Scene& s) {
    Light lamp;
    lamp.kind = LightKind::kPoint;
    lamp.color = glm::vec3(0);
    s.lighting.lights.push_back(lamp);
    lamp.color = glm::vec3(1);
    lamp.position = {0, 10, 0};
    lamp.range = 5;
    s.lighting.lights.push_back(lamp);
  };
  const auto scene = prepared({lights});
  std::string told;
  for (const LeftOut& one : left_out_of_object(*scene, 0, scene->scene.lighting)) {
    if (one.rule == NeedRule::kLights) told += one.what + ": " + one.why + "\n";
  }
  EXPECT_EQ(told,
            "1 of 3 lights: they are black\n"
            "1 of 3 lights: their range or cone ends before it\n");
}

}  // namespace
}  // namespace mirage::test
