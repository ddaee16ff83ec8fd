#include "server/bake/engine_texts.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <nlohmann/json.hpp>

#include "tests/server/bake/baked.h"

namespace mirage {
namespace {

const BakeText& text_of(const Baked& bake) { return bake.files.texts.at(0); }

bool has(const BakeText& text, const std::string& part) {
  return text.text.find(part) != std::string::npos;
}

TEST(EngineTexts, WriteNumbersThatAllLanguagesRead) {
  EXPECT_EQ(number(3), "3.0");
  EXPECT_EQ(number(-.0), "0.0");
  EXPECT_EQ(number(.1), "0.1");
  EXPECT_EQ(number(1e-7), "1e-07");
  EXPECT_EQ(number(1.0f / 3), "0.333333343");
}

TEST(EngineTexts, MakeAGodotScene) {
  const Baked bake = baked_arrows("godot4", BakeLayout::kHemi, 4, 8);
  const BakeText& scene = text_of(bake);
  EXPECT_EQ(scene.file, "arrows_imposter.tscn");
  for (const char* part :
       {"[gd_scene load_steps=11 format=3]", "path=\"base_arrows_albedo.png\" type=\"Texture2D\"",
        "shader_parameter/imposterFrames = Vector2(4, 4)", "shader_parameter/isFullSphere = false",
        "shader_parameter/scale = 2.5", "shader_parameter/aabb_max = 1.25",
        "shader_parameter/aabb_max = -1.25", "shader_parameter/depth_scale = 1.0",
        "shader_parameter/imposterTextureNormal = ExtResource(\"4\")",
        "Transform3D(1, 0, 0, 0, 1, 0, 0, 0, 1, 3.0, 1.0, -2.0)", "cast_shadow = 3"}) {
    EXPECT_TRUE(has(scene, part)) << part << "\n" << scene.text;
  }
}

TEST(EngineTexts, MakeAGodot3Scene) {
  const Baked bake = baked_arrows("godot3", BakeLayout::kOctahedral, 4, 8);
  const BakeText& scene = text_of(bake);
  EXPECT_EQ(scene.file, "arrows/impostor.tscn");
  for (const char* part : {"format=2]", "path=\"result_depth.png\" type=\"Texture\" id=5]",
                           "shader_param/isFullSphere = true", "mesh = SubResource( 3 )",
                           "[node name=\"mesh-impostor\" type=\"MeshInstance\" parent=\".\"]"}) {
    EXPECT_TRUE(has(scene, part)) << part << "\n" << scene.text;
  }
}

TEST(EngineTexts, NameOnlyPicturesThatExist) {
  const TargetFacts& target = *target_of("godot4");
  Baked bake = baked_arrows("godot4", BakeLayout::kHemi, 4, 8);
  const auto files = export_bake(bake.master, target, {"arrows", {"color"}, false});
  ASSERT_TRUE(files);
  EXPECT_TRUE(has(files->texts.at(0), "imposterTextureAlbedo"));
  EXPECT_FALSE(has(files->texts.at(0), "imposterTextureNormal"));
}

TEST(EngineTexts, GiveUnityItsValues) {
  const Baked bake = baked_arrows("unity-imp", BakeLayout::kHemi, 4, 8);
  const auto all = nlohmann::json::parse(text_of(bake).text);
  EXPECT_EQ(all["properties"]["_ImposterFrames"], 4);
  EXPECT_EQ(all["properties"]["_ImposterSize"], 2.5);
  EXPECT_EQ(all["properties"]["_ImposterOffset"], (std::vector<double>{-3, 1, -2}));
  EXPECT_EQ(all["textures"]["_ImposterBaseTex"]["file"], "arrows_ImposterBase.png");
  EXPECT_EQ(all["textures"]["_ImposterWorldNormalDepthTex"]["sRGBTexture"], false);
}

TEST(EngineTexts, GiveUnrealCentimetres) {
  const Baked bake = baked_arrows("unreal", BakeLayout::kHemi, 4, 8);
  const BakeText& script = text_of(bake);
  EXPECT_EQ(script.file, "import_arrows.py");
  for (const char* part : {"(\"FramesXY\", 4.0)", "(\"Default Mesh Size\", 500.0)",
                           "PIVOT_OFFSET = (300.0, -200.0, 100.0, 0.0)", "FULL_SPHERE = False",
                           "(\"T_arrows_Impostor_Normal.png\", \"Normal\", False)"}) {
    EXPECT_TRUE(has(script, part)) << part << "\n" << script.text;
  }
}

TEST(EngineTexts, LoadIntoThree) {
  const Baked bake = baked_arrows("three", BakeLayout::kHemi, 4, 8);
  const BakeText& loader = text_of(bake);
  EXPECT_EQ(loader.file, "arrows.three.js");
  for (const char* part :
       {"const FRAMES = 4;", "const RADIUS = 2.5;", "const CENTER = [3.0, 1.0, -2.0];",
        "load('arrows.albedo.png')", "load('arrows.normalDepth.png')", "impostorTransform.value"}) {
    EXPECT_TRUE(has(loader, part)) << part << "\n" << loader.text;
  }
}

}  // namespace
}  // namespace mirage
