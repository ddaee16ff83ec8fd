#include <gtest/gtest.h>

#include "server/scene/builtin/builtin_scene.h"

namespace mirage {
namespace {

void expect_refused(const std::string& spec, const std::string& named, const std::string& hinted) {
  const auto scene = build_builtin_scene(spec);
  ASSERT_FALSE(scene.ok()) << spec;
  EXPECT_EQ(scene.error().id, ErrorId::kSceneBuiltin) << spec;
  EXPECT_NE(scene.error().text.find(named), std::string::npos) << scene.error().line();
  EXPECT_NE(scene.error().hint.find(hinted), std::string::npos) << scene.error().line();
}

TEST(BuiltinOptions, RefusesUnknownScenes) {
  expect_refused("", "''", "forest");
  expect_refused("forrest", "forrest", "did you mean forest?");
  expect_refused("desert", "desert", "clutter, city, museum, knot, field");
  expect_refused(std::string(100000, 'x'), "xxx", "forest");
}

TEST(BuiltinOptions, RefusesUnknownOptions) {
  expect_refused("forest?tree=5", "tree", "did you mean trees?");
  expect_refused("museum?sculptures=5", "sculptures", "allowed: objects, seed, triangles");
  expect_refused("knot?colour=red", "colour", "allowed: R, r");
  expect_refused("city?=3", "''", "blocks");
  expect_refused("city?blocks=2&blocks=3", "twice", "");
}

TEST(BuiltinOptions, RefusesValuesOutOfRange) {
  expect_refused("forest?trees=0", "trees=0", "from 1 to 20000");
  expect_refused("forest?trees=20001", "trees=20001", "20000");
  expect_refused("forest?species=9", "species=9", "1 to 8");
  expect_refused("field?instances=1000001", "1000001", "1e+06");
  expect_refused("knot?R=nan", "nan", "from");
  expect_refused("knot?R=inf", "inf", "from");
  expect_refused("knot?R=1e999", "1e999", "from");
  expect_refused("knot?R=-1", "R=-1", "from");
  expect_refused("city?blocks=2.5", "2.5", "whole number");
  expect_refused("city?blocks=", "blocks=", "whole number");
  expect_refused("city?blocks", "blocks=", "whole number");
  expect_refused("city?blocks=3x", "3x", "whole number");
  expect_refused("museum?objects=0", "objects=0", "from 1 to 200");
  expect_refused("museum?objects=201", "objects=201", "from 1 to 200");
  expect_refused("museum?triangles=1000", "triangles=1000", "from 2000 to 2e+06");
  expect_refused("clutter?seed=-1", "seed=-1", "whole number");
}

TEST(BuiltinOptions, ListsEveryScene) {
  std::string names;
  for (const BuiltinSceneInfo& info : builtin_scenes()) {
    names += info.name + " ";
    EXPECT_FALSE(info.description.empty());
  }
  EXPECT_EQ(names, "forest clutter city museum knot field ");
  EXPECT_EQ(builtin_scenes()[0].options, "trees=400 species=4 seed=1 clutter=150 fog=0");
}

}  // namespace
}  // namespace mirage
