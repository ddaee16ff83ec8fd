// The door: one frame loop for whoever draws with a client, and several clients beside one another.
#include <gtest/gtest.h>

#include "client/door/client.h"
#include "client/draw/frame_renderer.h"
#include "client/draw/frame_target.h"
#include "client/frame/planned_frame.h"
#include "client/price/cost_fit.h"
#include "client/price/frame_work.h"
#include "client/screen/screen.h"
#include "shaders/gl/egl_context.h"
#include "tests/support/rig.h"

namespace mirage::test {
namespace {

constexpr int kWidth = 160, kHeight = 90;
constexpr double kFovY = 1;

ClientGraphics small_graphics() {
  ClientGraphics graphics;
  graphics.width = kWidth;
  graphics.height = kHeight;
  graphics.atlas_edge = 512;
  graphics.atlas_layers = 4;
  return graphics;
}

/// A client of a server in this process, and its clock.
class Guest {
 public:
  explicit Guest(Host& host, Client& client) : client_(client), link_(host) {
    ClientOptions options;
    options.screen.width = kWidth;
    options.screen.height = kHeight;
    client_.open(link_, options, [](const Error& error) { ADD_FAILURE() << error.line(); });
  }
  ~Guest() { client_.close(); }
  FrameStep frame() {
    now_us_ += 16'667;
    EXPECT_TRUE(client_.update(now_us_).ok());
    EXPECT_TRUE(client_.resize(kWidth, kHeight).ok());
    const Camera camera = client_.camera(eye_at({0, 0, 9}, {0, 0, -12}), kFovY);
    const Result<FrameStep> step = client_.plan(camera, now_us_);
    EXPECT_TRUE(step.ok());
    client_.draw();
    return *step;
  }
  std::vector<std::uint8_t> picture_at_rest() {
    for (int i = 0; i < 600; ++i) {
      if (frame() == FrameStep::kKeep && client_.session().at_rest()) break;
    }
    EXPECT_TRUE(client_.session().at_rest() && client_.screen().refined());
    return client_.screen().shown().read();
  }

 private:
  Client& client_;
  HostLink link_;
  std::int64_t now_us_ = 0;
};

class Door : public ::testing::Test {
 protected:
  void SetUp() override {
    Result<gl::EglContext> egl = gl::EglContext::create("auto");
    ASSERT_TRUE(egl.ok());
    egl_ = std::move(*egl);
  }

  gl::EglContext egl_;
  HandClock clock_;
  Host host_{rig_scene({}), clock_, {}};
};

TEST_F(Door, AFrameIsUpdatedPlannedAndDrawnUntilItRests) {
  Client client;
  ASSERT_TRUE(client.attach(small_graphics()).ok());
  client.set_prices(*device_model("software"));
  Guest guest(host_, client);
  const std::vector<std::uint8_t> picture = guest.picture_at_rest();
  std::size_t covered = 0;
  for (std::size_t i = 3; i < picture.size(); i += 4) covered += picture[i] > 0;
  EXPECT_GT(covered, std::size_t{kWidth} * kHeight / 50) << "the picture shows objects";
  EXPECT_FALSE(client.planned().list.impostors.empty());
  EXPECT_GT(client.drawn_work()[Work::kPixel], 0);
  EXPECT_EQ(guest.frame(), FrameStep::kKeep) << "nothing changes any more";
  EXPECT_EQ(client.screen().shown().read(), picture);
}

TEST_F(Door, TwoClientsOfOneProgramDrawWhatEachAloneDraws) {
  Client one, other;
  ASSERT_TRUE(one.attach(small_graphics()).ok());
  ASSERT_TRUE(other.attach(small_graphics()).ok());
  std::vector<std::uint8_t> alone;
  {
    Guest guest(host_, one);
    alone = guest.picture_at_rest();
  }
  Guest first(host_, one), second(host_, other);
  for (int i = 0; i < 20; ++i) {
    first.frame();
    second.frame();
  }
  EXPECT_EQ(first.picture_at_rest(), alone) << "the same client, on its second connection";
  EXPECT_EQ(second.picture_at_rest(), alone);
}

TEST_F(Door, AClientWithoutGraphicsLearnsTheScene) {
  Client client;
  HostLink link(host_);
  client.open(link, {}, {});
  for (int i = 1; i < 20 && !client.session().scene().complete(); ++i) {
    ASSERT_TRUE(client.update(16'667 * i).ok());
  }
  EXPECT_TRUE(client.session().scene().complete());
  client.close();
}

TEST_F(Door, PricesAreLearntFromWhatFramesTook) {
  Client client;
  ASSERT_TRUE(client.attach(small_graphics()).ok());
  EXPECT_EQ(client.prices(), nullptr);
  const CostModel usual = *device_model("software");
  client.set_prices(usual);
  Guest guest(host_, client);
  guest.picture_at_rest();
  const double before = usual.ms_of(client.drawn_work());
  for (int i = 0; i < 50; ++i) client.learn(client.drawn_work(), 3 * before);
  EXPECT_GT(client.prices()->model().ms_of(client.drawn_work()), 2 * before);
}

}  // namespace
}  // namespace mirage::test
