// Video baseline: when its frames arrive, how they are turned, and what the codec does to them.
#include <gtest/gtest.h>

#include <cmath>

#include "client/report/video_link.h"
#ifdef MIRAGE_HAS_VIDEO
#include "client/report/video_codec.h"
#endif

namespace mirage::test {
namespace {

NetModel link(double rtt_ms, double rate_mbps) {
  NetModel net;
  net.rtt_ms = rtt_ms;
  net.rate_mbps = rate_mbps;
  return net;
}

// A byte takes 0.8 us at 10 Mbit/s.
constexpr std::size_t kTenMs = 12'500 - kVideoFraming;

TEST(VideoLink, AFrameTakesTheTripItsServerTimeAndItsBytes) {
  const VideoTiming timing{50, 10, 2, 3};
  const NetModel net = link(100, 10);
  const int first = first_video_frame(net, timing.fps);
  EXPECT_EQ(first, 10);  // two round trips to connect
  const auto arrivals = video_arrivals({kTenMs, kTenMs}, first, timing, net);
  const std::int64_t pose_up = 64;
  EXPECT_EQ(arrivals[0], 200'000 + pose_up + 50'000 + 12'000 + 10'000 + 50'000 + 3'000);
  EXPECT_EQ(arrivals[1], arrivals[0] + 20'000);  // the link is free in between
}

TEST(VideoLink, FramesLargerThanTheRateQueueUp) {
  const VideoTiming timing{100, 0, 0, 0};  // every 10 ms
  const auto arrivals = video_arrivals(std::vector<std::size_t>(5, 2 * kTenMs + kVideoFraming), 0,
                                       timing, link(0, 10));
  for (std::size_t i = 1; i < arrivals.size(); ++i) {
    EXPECT_EQ(arrivals[i] - arrivals[i - 1], 20'000);
  }
}

TEST(VideoLink, JitterAndLossKeepTheOrderAndTheSeed) {
  NetModel net = link(100, 100);
  net.jitter_ms = 30;
  net.loss_percent = 5;
  const std::vector<std::size_t> bytes(200, 1000);
  const VideoTiming timing{60, 0, 0, 0};
  const auto a = video_arrivals(bytes, 12, timing, net), b = video_arrivals(bytes, 12, timing, net);
  EXPECT_EQ(a, b);
  EXPECT_TRUE(std::is_sorted(a.begin(), a.end()));
  net.seed = 2;
  EXPECT_NE(a, video_arrivals(bytes, 12, timing, net));
}

Camera camera(double yaw) {
  Camera c;
  c.width = 64;
  c.height = 36;
  c.pose = look_at({0, 0, 0}, {std::sin(yaw), 0, -std::cos(yaw)});
  return c;
}

// Brightness rises by 3 a column, so that it tells where a pixel comes from.
std::vector<std::uint8_t> ramp() {
  std::vector<std::uint8_t> out;
  for (int i = 0; i < 64 * 36; ++i) {
    const auto v = static_cast<std::uint8_t>(3 * (i % 64));
    out.insert(out.end(), {v, v, v, 255});
  }
  return out;
}

TEST(Timewarp, WithoutATurnNothingChanges) {
  std::size_t outside = 1;
  EXPECT_EQ(timewarp(ramp(), camera(0.3), camera(0.3), outside), ramp());
  EXPECT_EQ(outside, 0u);
}

TEST(Timewarp, ATurnToTheRightShowsWhatWasOnTheRightAndAHoleThere) {
  const double yaw = 0.05;
  std::size_t outside = 0;
  const auto turned = timewarp(ramp(), camera(0), camera(yaw), outside);
  const std::size_t middle = 4 * (18 * 64 + 32);
  const double shift = camera(0).focal_px() * std::tan(yaw);
  ASSERT_GT(shift, 1);
  EXPECT_NEAR(turned[middle], 3 * (32 + shift), 2);
  const std::size_t right_edge = 4 * (18 * 64 + 63), left_edge = 4 * (18 * 64);
  EXPECT_EQ(turned[right_edge], 0);  // black, but covered: an error, not a gap in the mask
  EXPECT_EQ(turned[right_edge + 3], 255);
  // The left edge shows what lay at its own angle plus the turn.
  const double f = camera(0).focal_px();
  const double from = f * std::tan(std::atan(-31.5 / f) + yaw) + 31.5;
  EXPECT_NEAR(turned[left_edge], 3 * from, 2);
  EXPECT_GE(outside, 36u);  // at least a column
}

TEST(Timewarp, BehindTheCameraIsNothing) {
  std::size_t outside = 0;
  const auto turned = timewarp(ramp(), camera(0), camera(3.0), outside);
  EXPECT_EQ(outside, std::size_t{64 * 36});
}

#ifdef MIRAGE_HAS_VIDEO
TEST(VideoCodec, IsGoodAndKeepsTheRate) {
  constexpr int kW = 65, kH = 37;  // odd sizes are padded
  std::vector<std::vector<std::uint8_t>> frames;
  std::vector<const std::uint8_t*> pointers;
  for (int f = 0; f < 12; ++f) {
    frames.emplace_back();
    for (int y = 0; y < kH; ++y) {
      for (int x = 0; x < kW; ++x) {
        const auto v =
            static_cast<std::uint8_t>(128 + 60 * std::sin(0.2 * (x + f)) * std::cos(0.3 * y));
        frames.back().insert(frames.back().end(), {v, v, static_cast<std::uint8_t>(255 - v), 255});
      }
    }
  }
  for (const auto& frame : frames) pointers.push_back(frame.data());
  const Result<CodedVideo> good = code_video(pointers, kW, kH, 30, 20);
  ASSERT_TRUE(good.ok()) << good.error().text;
  ASSERT_EQ(good->frames.size(), frames.size());
  double squares = 0;
  for (std::size_t i = 0; i < frames[11].size(); ++i) {
    const double d = int{frames[11][i]} - int{good->frames[11].rgba[i]};
    squares += d * d;
  }
  EXPECT_LT(std::sqrt(squares / static_cast<double>(frames[11].size())), 4);
  EXPECT_GT(good->encode_ms, 0);
  const Result<CodedVideo> narrow = code_video(pointers, kW, kH, 30, 0.05);
  ASSERT_TRUE(narrow.ok());
  std::size_t wide_bytes = 0, narrow_bytes = 0;
  for (std::size_t i = 0; i < frames.size(); ++i) {
    wide_bytes += good->frames[i].bytes;
    narrow_bytes += narrow->frames[i].bytes;
  }
  EXPECT_LT(narrow_bytes, wide_bytes / 2);
}
#endif

}  // namespace
}  // namespace mirage::test
