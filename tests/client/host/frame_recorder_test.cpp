// Where the time of frames went, and why late ones were late.
#include "client/host/frame_recorder.h"

#include <gtest/gtest.h>

#include <cmath>
#include <nlohmann/json.hpp>

namespace mirage {
namespace {

class Frames : public testing::Test {
 protected:
  // A frame whose stages take so many ms.
  void frame(double receive, double upload, double draw, RecordedFrame facts) {
    recorder_.begin();
    pass(receive + upload);
    recorder_.lap(FrameStage::kReceive, upload);
    pass(draw);
    recorder_.lap(FrameStage::kDraw);
    recorder_.end(facts);
  }
  void pass(double ms) { clock_.advance_to_us(clock_.now_us() + std::llround(1000 * ms)); }
  static RecordedFrame facts_of(std::uint32_t visible, std::uint32_t placeholders) {
    RecordedFrame out;
    out.budget_ms = 50;
    out.visible = visible;
    out.placeholders = placeholders;
    return out;
  }

  VirtualClock clock_;
  FrameRecorder recorder_{clock_};
};

TEST_F(Frames, StagesAddUpToTheWhole) {
  frame(1, 2, 30, facts_of(10, 1));
  ASSERT_EQ(recorder_.frames().size(), 1u);
  const RecordedFrame& one = recorder_.frames().front();
  EXPECT_NEAR(one.all_ms(), 33, 1e-3);
  EXPECT_NEAR(one.ms[static_cast<std::size_t>(FrameStage::kUpload)], 2, 1e-3);
  EXPECT_FALSE(one.late());
}

TEST_F(Frames, ALateFrameNamesTheStageThatTookMoreThanUsual) {
  for (int i = 0; i < 20; ++i) frame(1, 1, 40, facts_of(10, 0));
  frame(1, 20, 40, facts_of(10, 0));  // 61 ms of 50, although drawing takes most of it
  frame(1, 1, 160, facts_of(10, 0));  // more than three budgets
  const nlohmann::ordered_json summary = recorder_.summary();
  EXPECT_EQ(summary["late"], 2);
  EXPECT_EQ(summary["over_3_budgets"], 1);
  EXPECT_EQ(summary["late_causes"]["upload"], 1);
  EXPECT_EQ(summary["late_causes"]["draw"], 1);
  EXPECT_EQ(summary["late_causes"]["show"], 0);
  EXPECT_EQ(recorder_.json()[20]["late"], "upload");
  EXPECT_TRUE(recorder_.json()[0]["late"].is_null());
}

TEST_F(Frames, MissingImagesAreCountedFromTheFifthSecondApart) {
  frame(0, 0, 10, facts_of(10, 10));
  pass(5000);
  frame(0, 0, 10, facts_of(30, 0));
  EXPECT_DOUBLE_EQ(recorder_.summary()["placeholder_fraction"], 0.25);
  EXPECT_DOUBLE_EQ(recorder_.summary()["placeholder_fraction_after_5s"], 0.0);
}

TEST_F(Frames, NoFramesAreNoFigures) {
  EXPECT_TRUE(recorder_.summary()["ms"]["p50"].is_null());
  EXPECT_TRUE(recorder_.json().empty());
}

}  // namespace
}  // namespace mirage
