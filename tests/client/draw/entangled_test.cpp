// Entangled impostors: those that lie in one another, and no others.
#include "client/draw/entangled.h"

#include <gtest/gtest.h>

#include "tests/support/core_scene.h"

namespace mirage::test {
namespace {

using Ids = std::vector<std::uint32_t>;

Ids entangled_of(const std::vector<Placed>& placed, const Ids& drawn) {
  const SceneView scene = make_scene(placed);
  std::vector<DrawnImpostor> impostors(drawn.size());
  for (std::size_t i = 0; i < drawn.size(); ++i) impostors[i].instance = drawn[i];
  return entangled(impostors, scene);
}

TEST(ClientEntangled, AThingInAnotherIsEntangledWithIt) {
  // a helmet of radius 1 m, a strap in it, and a cup that only meets its sphere
  const std::vector<Placed> placed = {{{0, 0, 0}, 1}, {{0.6, 0.6, 0}, 0.2f}, {{0, 1.1, 0}, 0.2f}};
  EXPECT_EQ(entangled_of(placed, {2, 1, 0}), (Ids{0, 1}));
  EXPECT_EQ(entangled_of(placed, {1, 2}), Ids{});
}

TEST(ClientEntangled, AnImageThatFadesInIsNotEntangledWithTheFormerOne) {
  EXPECT_EQ(entangled_of({{{0, 0, 0}, 1}, {{5, 0, 0}, 1}}, {0, 0, 1}), Ids{});
}

TEST(ClientEntangled, ASmallThingIsFoundFarAlongALargeOne) {
  const std::vector<Placed> placed = {{{0, 0, 0}, 10}, {{-8, 0, 0}, 0.1f}, {{8, 0, 0}, 0.1f}};
  EXPECT_EQ(entangled_of(placed, {0, 1, 2}), (Ids{0, 1, 2}));
}

}  // namespace
}  // namespace mirage::test
