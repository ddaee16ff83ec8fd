#include <gtest/gtest.h>

#include <limits>

#include "client/core/sample_choice.h"

namespace mirage {
namespace {

TEST(CoreSamples, StayWhileFramesAreQuickAndGoOnceSeveralInARowAreSlow) {
  SampleChoice choice(-1);
  for (int i = 0; i < 100; ++i) EXPECT_FALSE(choice.note_drawn(SampleChoice::kSlowMs));
  EXPECT_EQ(choice.samples(), SampleChoice::kMost);
  for (int start = 0; start < 2; ++start) {
    for (int i = 0; i < 6; ++i) EXPECT_FALSE(choice.note_drawn(220));
    EXPECT_FALSE(choice.note_drawn(5)) << "shaders were finished, no more";
  }
  for (int i = 0; i < 2; ++i) EXPECT_FALSE(choice.note_drawn(20'000)) << "one is none too many";
  EXPECT_EQ(choice.samples(), SampleChoice::kMost);
  EXPECT_TRUE(choice.note_drawn(20'000));
  EXPECT_EQ(choice.samples(), 0);
  for (int i = 0; i < 100; ++i) EXPECT_FALSE(choice.note_drawn(1)) << "it does not turn back";
  EXPECT_EQ(choice.samples(), 0);
}

TEST(CoreSamples, AreAsManyAsSaidWhateverFramesTake) {
  for (const int fixed : {0, 1, 2, 4, 16}) {
    SampleChoice choice(fixed);
    for (int i = 0; i < 10; ++i) EXPECT_FALSE(choice.note_drawn(10'000));
    EXPECT_EQ(choice.samples(), fixed);
  }
}

TEST(CoreSamples, FollowTheFrameTimeAskedForAndNoMeterThatIsBroken) {
  SampleChoice strict(-1, 10), patient(-1, 200), broken(-1);
  for (int i = 0; i < 200; ++i) {
    strict.note_drawn(11);
    patient.note_drawn(199);
    broken.note_drawn(std::numeric_limits<double>::quiet_NaN());
  }
  EXPECT_EQ(strict.samples(), 0);
  EXPECT_EQ(patient.samples(), SampleChoice::kMost);
  EXPECT_EQ(broken.samples(), SampleChoice::kMost);
  for (int i = 0; i < 8; ++i) patient.note_drawn(201);
  EXPECT_EQ(patient.samples(), 0);
}

}  // namespace
}  // namespace mirage
