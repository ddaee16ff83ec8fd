// The arithmetic of a freeze, before and after the server has spoken: eyes, budget, parts, opening.
#include <gtest/gtest.h>

#include "client/folder/frozen_file.h"
#include "client/freeze/budget.h"
#include "client/freeze/eyes.h"
#include "client/freeze/frozen_part.h"
#include "client/freeze/opening.h"
#include "protocol/base/limits.h"
#include "tests/support/protocol_samples.h"

namespace mirage::test {
namespace {

FrozenEntry tile_entry(std::uint16_t x, std::uint32_t bytes, double gain, bool spare = false) {
  FrozenEntry out;
  out.tile = wire::FrozenTile(x, bytes, 1, 1, 0, x, 0, 0, 9, 4, 6, 3, 1);
  out.gain = gain;
  out.spare = spare;
  return out;
}
FrozenEntry mesh_entry(std::uint32_t object, std::uint8_t level, std::uint32_t bytes) {
  FrozenEntry out;
  out.is_tile = false;
  out.asset = wire::FrozenAsset(level, bytes, object, level, false);
  return out;
}
FrozenPart part_of(const std::vector<FrozenEntry>& entries) {
  FrozenPart out;
  for (const FrozenEntry& entry : entries) out.files[entry.name(7)] = entry;
  return out;
}

TEST(FreezeEyes, StandAroundTheTargetAtTwoDistancesWithTheHomeViewAmongThem) {
  FreezeOptions options;
  HomeView home;
  home.eye = {0, 1, 4};
  home.target = {0, 0, 0};
  const double distance = glm::length(home.eye);
  std::size_t near = 0, far = 0, home_views = 0;
  for (const EyePart& part : eye_parts(options, home)) {
    for (const Pose& pose : part) {
      const double d = glm::length(pose.eye - home.target);
      if (std::abs(d - distance) < 1e-9) ++far;
      if (std::abs(d - 0.6 * distance) < 1e-9) ++near;
      if (glm::length(pose.eye - home.eye) < 1e-9) ++home_views;
      const Camera camera{pose};
      EXPECT_GT(glm::dot(camera.forward(), glm::normalize(home.target - pose.eye)), 0.999999);
    }
  }
  EXPECT_GT(far, 60u);
  EXPECT_EQ(near, far);
  EXPECT_EQ(home_views, 1u);
}

TEST(FreezeEyes, FillABoxToItsCornersAndLookAround) {
  FreezeOptions options;
  options.box = EyeBox{{-1, 1, -2}, {1, 1, 2}};
  const std::vector<EyePart> parts = eye_parts(options, HomeView{});
  bool low = false, high = false;
  for (const EyePart& part : parts) {
    EXPECT_EQ(part.size(), 12u);
    for (const Pose& pose : part) EXPECT_DOUBLE_EQ(pose.eye.y, 1);
    low = low || glm::length(part.front().eye - options.box->low) < 1e-9;
    high = high || glm::length(part.front().eye - options.box->high) < 1e-9;
  }
  EXPECT_TRUE(low && high);
  options.box = EyeBox{{3, 2, 1}, {3, 2, 1}};
  EXPECT_EQ(eye_parts(options, HomeView{}).size(), 1u) << "a point";
}

TEST(FreezeEyes, BetweenTwoEyesLiesOne) {
  const EyePart two = {look_at({0, 0, 4}, {0, 0, 0}), look_at({4, 0, 0}, {0, 0, 0})};
  const EyePart middle = between(two);
  ASSERT_EQ(middle.size(), 1u);
  EXPECT_NEAR(glm::length(middle.front().eye - glm::dvec3(2, 0, 2)), 0, 1e-9);
}

TEST(FreezeBudget, KeepsGeometryThenTilesByTheirWorth) {
  const FrozenPart part =
      part_of({mesh_entry(1, 0, 500), mesh_entry(1, 3, 50), tile_entry(1, 100, 9, true),
               tile_entry(2, 100, 2), tile_entry(3, 100, 5)});
  const Kept all = within_budget(part, 10'000);
  EXPECT_EQ(all.files.size(), 5u);
  EXPECT_EQ(all.bytes, 850u);
  EXPECT_TRUE(all.left_out.empty());
  const Kept some = within_budget(part, 700);
  EXPECT_EQ(some.bytes, 650u);
  ASSERT_EQ(some.left_out.size(), 2u);
  EXPECT_EQ(some.left_out[0], tile_entry(2, 100, 2).name(7)) << "worth less than tile 3";
  EXPECT_EQ(some.left_out[1], tile_entry(1, 100, 9, true).name(7)) << "geometry shows the same";
  const Kept few = within_budget(part, 160);
  ASSERT_EQ(few.files.size(), 2u);
  EXPECT_EQ(few.bytes, 150u) << "the coarse level and tile 3; the fine level does not fit";
  EXPECT_TRUE(within_budget(part, 0).files.empty());
}

TEST(FreezePart, IsReadBackAndRefusedWhenCut) {
  FrozenPart part = part_of({mesh_entry(1, 0, 500), tile_entry(1, 100, 9, true)});
  part.opening = {encode_message(sample_object_page())};
  part.pages = {encode_message(sample_instance_page())};
  part.view = {1, 2, 3};
  part.eyes = 12;
  const Bytes file = encode_part(part);
  const Result<FrozenPart> back = decode_part(file);
  ASSERT_TRUE(back.ok());
  EXPECT_EQ(encode_part(*back), file);
  EXPECT_EQ(back->files.size(), 2u);
  EXPECT_EQ(back->eyes, 12u);
  for (std::size_t size = 0; size < file.size(); size += 11) {
    EXPECT_FALSE(decode_part(Bytes(file.begin(), file.begin() + static_cast<long>(size))).ok());
  }
}

TEST(FreezePart, OfTwoTheLargerWorthStays) {
  FrozenPart one = part_of({tile_entry(1, 100, 2, true)});
  one.add(part_of({tile_entry(1, 100, 3), tile_entry(2, 100, 1, true)}));
  EXPECT_EQ(one.files.size(), 2u);
  EXPECT_EQ(one.files.at(tile_entry(1, 0, 0).name(7)).gain, 3);
  EXPECT_FALSE(one.files.at(tile_entry(1, 0, 0).name(7)).spare);
  EXPECT_TRUE(one.files.at(tile_entry(2, 0, 0).name(7)).spare);
}

TEST(FreezeOpening, PromisesNothingThatTheFolderLacks) {
  wire::WelcomeT welcome = sample_welcome();
  welcome.reference = welcome.geometry = true;
  welcome.walk_eye_m = 1.7;
  FrozenPart part = part_of({tile_entry(1, 100, 1)});
  part.opening = {encode_message(std::move(welcome)), encode_message(sample_object_page())};
  const Result<std::vector<Bytes>> opening = opening_of(part, within_budget(part, 1000));
  ASSERT_TRUE(opening.ok());
  std::size_t catalogues = 0, welcomes = 0;
  for (const Bytes& bytes : *opening) {
    const Message message = decode_message(bytes.data(), bytes.size()).take();
    if (message.body.AsCatalogue()) ++catalogues;
    if (const wire::ObjectPageT* page = message.body.AsObjectPage()) {
      for (const auto& object : page->objects) EXPECT_TRUE(object->lods.empty());
    }
    const wire::WelcomeT* told = message.body.AsWelcome();
    if (!told) continue;
    ++welcomes;
    EXPECT_FALSE(told->reference);
    EXPECT_FALSE(told->geometry);
    EXPECT_EQ(told->walk_eye_m, 0);
    EXPECT_TRUE(told->clips.empty());
    EXPECT_EQ(told->codecs, std::vector<std::uint8_t>{told->codec});
  }
  EXPECT_EQ(catalogues, 1u);
  EXPECT_EQ(welcomes, 1u);
}

}  // namespace
}  // namespace mirage::test
