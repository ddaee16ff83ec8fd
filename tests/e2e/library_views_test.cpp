// Several views a frame by libmirage-client: two eyes, or the parts of a window.
#include <cstdio>

#include "tests/support/library_fixture.h"

namespace mirage::test {
namespace {

/// Looks from the side: the world's x to the left.
mirage_view from_the_side(double distance) {
  mirage_view view = view_from(0);
  view.eye[0] = distance;
  view.rotation[1] = std::sqrt(0.5);
  view.rotation[3] = std::sqrt(0.5);
  return view;
}

/// Sees the upper right part of view_from(z) in a picture of half the edges.
mirage_view corner_of(double z) {
  mirage_view view = view_from(z);
  view.tan_left = view.tan_down = 0;
  view.width /= 2;
  view.height /= 2;
  return view;
}

/// Canvases of a frame's views.
struct Canvases {
  explicit Canvases(std::size_t count) : all(count) {}
  std::vector<mirage_target> targets() const {
    std::vector<mirage_target> out;
    for (const Canvas& canvas : all) out.push_back(canvas.target());
    return out;
  }
  std::vector<Canvas> all;
};

/// Returns the pictures of a frame's views at rest, each in a canvas that is cleared before.
std::vector<Pixels> pictures(LibraryClient& client, const std::vector<mirage_view>& views) {
  const Canvases canvases(views.size());
  EXPECT_TRUE(client.rest(views, canvases.targets()));
  std::vector<Pixels> out;
  for (std::size_t i = 0; i < views.size(); ++i) {
    const mirage_target target = canvases.all[i].target();
    canvases.all[i].clear(1);
    EXPECT_EQ(mirage_composite(client.get(), static_cast<std::int32_t>(i), &target), MIRAGE_OK);
    out.push_back(canvases.all[i].read());
  }
  return out;
}

std::uint64_t tiles_of(LibraryClient& client) {
  mirage_stats stats = sized<mirage_stats>();
  EXPECT_EQ(mirage_get_stats(client.get(), &stats), MIRAGE_OK);
  return stats.tiles_received;
}

// All of them are near enough to draw the knot from its geometry. A view from farther off would
// draw it from tiles, unless another view has brought its geometry.
TEST_F(Library, EachOfSeveralViewsIsThePictureOfThatViewAlone) {
  const std::vector<mirage_view> views = {view_from(9), from_the_side(12), corner_of(9),
                                          view_from(10)};
  LibraryClient together(server_.url());
  const std::vector<Pixels> seen = pictures(together, views);
  for (std::size_t i = 0; i < views.size(); ++i) {
    LibraryClient alone(server_.url());
    EXPECT_EQ(different(seen[i], pictures(alone, {views[i]})[0]), 0u) << "view " << i;
  }
  EXPECT_GT(different(seen[0], seen[3]), 1000u) << "they are not all one";
}

TEST_F(Library, ViewsComeAndGo) {
  LibraryClient client(server_.url());
  const Pixels alone = pictures(client, {view_from(9)})[0];
  for (const std::size_t count : {2u, 4u, 3u, 1u}) {
    std::vector<mirage_view> views(count, from_the_side(12));
    views.back() = view_from(9);
    EXPECT_EQ(different(pictures(client, views).back(), alone), 0u) << count << " views";
  }
}

TEST_F(Library, AViewThatIsNotThereOrNotRightIsAnError) {
  LibraryClient client(server_.url());
  const Canvas canvas;
  const mirage_target target = canvas.target();
  ASSERT_TRUE(client.rest(view_from(9), target));
  std::vector<mirage_view> views(5, view_from(9));
  const auto plan = [&](std::int32_t count) {
    return mirage_plan(client.get(), views.data(), count, clock_us(), nullptr);
  };
  EXPECT_EQ(plan(0), MIRAGE_BAD_ARGUMENT);
  EXPECT_EQ(plan(-1), MIRAGE_BAD_ARGUMENT);
  EXPECT_EQ(plan(5), MIRAGE_BAD_ARGUMENT);
  EXPECT_EQ(plan(4), MIRAGE_OK);
  EXPECT_EQ(mirage_draw(client.get(), 3, &target), MIRAGE_OK);
  EXPECT_EQ(mirage_draw(client.get(), 4, &target), MIRAGE_BAD_ARGUMENT);
  EXPECT_EQ(mirage_draw(client.get(), -1, &target), MIRAGE_BAD_ARGUMENT);
  views[1].tan_up = std::nan("");
  EXPECT_EQ(plan(2), MIRAGE_BAD_ARGUMENT);
  mirage_error error = sized<mirage_error>();
  ASSERT_EQ(mirage_client_error(client.get(), &error), MIRAGE_OK);
  EXPECT_NE(std::string(error.text).find("view 1"), std::string::npos) << error.text;
  views[1] = view_from(9);
  views[1].size -= 8;
  EXPECT_EQ(plan(2), MIRAGE_BAD_ARGUMENT);
  EXPECT_EQ(plan(1), MIRAGE_OK);
}

// A header newer than the library has larger structs: the second view begins where the host's does.
TEST_F(Library, ViewsMayBeLargerThanTheLibraryKnows) {
  struct Newer {
    mirage_view view;
    double more[3];
  };
  LibraryClient client(server_.url());
  const Pixels side = pictures(client, {view_from(9), from_the_side(12)})[1];
  std::array<Newer, 2> newer{};
  newer[0].view = view_from(9);
  newer[1].view = from_the_side(12);
  for (Newer& one : newer) one.view.size = sizeof(Newer);
  ASSERT_EQ(mirage_plan(client.get(), &newer[0].view, 2, clock_us(), nullptr), MIRAGE_OK);
  const Canvas canvas;
  const mirage_target target = canvas.target();
  ASSERT_EQ(mirage_draw(client.get(), 1, &target), MIRAGE_OK);
  EXPECT_EQ(different(canvas.read(), side), 0u);
}

class LibraryForest : public Library {
 protected:
  LibraryForest() : Library("builtin:forest") {}
};

// Both eyes of a person see nearly the same: most tiles serve both.
TEST_F(LibraryForest, TwoEyesTakeLittleMoreThanOne) {
  mirage_view left = view_from(0);
  left.eye[1] = 1.7;
  mirage_view right = left;
  right.eye[0] = 0.064;
  LibraryClient one(server_.url()), both(server_.url());
  const Canvases canvases(2);
  ASSERT_TRUE(one.rest(left, canvases.all[0].target()));
  ASSERT_TRUE(both.rest({left, right}, canvases.targets()));
  mirage_frame_info info = sized<mirage_frame_info>();
  const std::array<mirage_view, 2> eyes = {left, right};
  ASSERT_EQ(mirage_plan(both.get(), eyes.data(), 2, clock_us(), &info), MIRAGE_OK);
  EXPECT_EQ(info.placeholders, 0u);
  EXPECT_EQ(info.over_tau, 0u);
  std::printf("tiles of one eye %llu, of both %llu\n",
              static_cast<unsigned long long>(tiles_of(one)),
              static_cast<unsigned long long>(tiles_of(both)));
  EXPECT_GT(tiles_of(one), 10u);
  EXPECT_LT(static_cast<double>(tiles_of(both)), 1.5 * static_cast<double>(tiles_of(one)));
}

}  // namespace
}  // namespace mirage::test
