// Codec choice: by the link's share of a trip, with hysteresis, and never a codec without an offer.
#include "client/ask/codec_choice.h"

#include <gtest/gtest.h>

namespace mirage::test {
namespace {

using C = TileCodec;
const std::vector<C> kAll = {C::kZstd, C::kRaw, C::kWebp};

// A client with frames every 100 ms, on a link as given.
class CoreCodecChoice : public ::testing::Test {
 protected:
  CoreCodecChoice() { choice.reset(kAll); }
  /// Frames for `seconds`: tiles take `way_ms` there and back, and wait up to `queue_ms` more.
  C run(double seconds, double way_ms, double queue_ms, const LinkLoad& load,
        double server_ms = 5) {
    C out = C::kZstd;
    for (int i = 0; i < seconds * 10; ++i) {
      now_us += 100'000;
      for (int k = 0; k < 3; ++k) {
        const bool first = tiles++ % 11 == 0;  // the first of a burst, which waits for no other
        const double wait = first ? 0 : queue_ms;
        const auto server = static_cast<std::int64_t>(1000 * (first ? 5 : server_ms));
        choice.tile_arrived(static_cast<std::int64_t>(1000 * (way_ms + wait)) + server, server);
      }
      out = choice.update(load, now_us);
    }
    return out;
  }
  CodecChoice choice;
  std::int64_t now_us = 0;
  int tiles = 0;
};

TEST_F(CoreCodecChoice, OrdinaryLinksAreLossless) {
  EXPECT_EQ(run(5, 100, 0, {2, 0}), C::kZstd);
  EXPECT_EQ(run(5, 100, 45, {19, 5}), C::kZstd) << "full, but much comes through";
  EXPECT_EQ(run(5, 100, 45, {2, 0.5}), C::kZstd) << "full for a moment";
}

TEST_F(CoreCodecChoice, ThinAndFullIsLossyUntilThereIsRoom) {
  EXPECT_EQ(run(3, 100, 45, {2, 3}), C::kWebp);
  EXPECT_EQ(run(60, 100, 0, {1.5, 0}), C::kWebp) << "without loss it would be full again";
  EXPECT_EQ(run(4, 100, 0, {0.3, 0}), C::kWebp) << "a pause";
  EXPECT_EQ(run(2, 100, 0, {0.3, 0}), C::kZstd) << "a long one";
  EXPECT_EQ(run(3, 100, 45, {2, 3}), C::kWebp);
  EXPECT_EQ(run(2, 100, 45, {12, 3}), C::kZstd) << "the link delivers more";
}

TEST_F(CoreCodecChoice, SlowServerIsNoThinLink) {
  EXPECT_EQ(run(20, 100, 0, {2, 10}, 400), C::kZstd);
}

TEST_F(CoreCodecChoice, AFastLinkIsTheServersOwnChoice) {
  EXPECT_EQ(run(2, 4, 0.5, {40, 0}), C::kZstd);
}

TEST_F(CoreCodecChoice, NeverWhatTheServerDoesNotHave) {
  choice.reset({C::kZstd});
  EXPECT_EQ(run(3, 100, 45, {2, 3}), C::kZstd);
  EXPECT_EQ(run(3, 1, 0, {40, 0}), C::kZstd);
  CodecChoice forced(C::kWebp);
  forced.reset(kAll);
  EXPECT_EQ(forced.update({}, 1), C::kWebp);
  forced.reset({C::kRaw});
  EXPECT_EQ(forced.update({}, 1), C::kRaw) << "the server's own";
  EXPECT_EQ(forced.unasked(), C::kRaw);
}

TEST_F(CoreCodecChoice, NewConnectionKnowsNothingOfTheOld) {
  ASSERT_EQ(run(3, 100, 45, {2, 3}), C::kWebp);
  choice.reset(kAll);
  EXPECT_EQ(choice.update({2, 3}, now_us), C::kZstd);
}

}  // namespace
}  // namespace mirage::test
