// Upload queue: a budget for each frame, first images first, nothing lost, times that never run
// backwards.
#include <gtest/gtest.h>

#include <set>

#include "client/hold/upload_queue.h"
#include "protocol/impostor/tile.h"
#include "protocol/impostor/tile_key.h"

namespace mirage::test {
namespace {

constexpr std::size_t kCost = 100;
constexpr std::uint32_t kFirstImage = 1000;  // ids from here on: instances that show nothing

Message tile(std::uint32_t request, std::int64_t waited_us = 0) {
  wire::TileReplyT reply;
  reply.request_id = request;
  Message message;
  message.body.Set(std::move(reply));
  message.waited_us = waited_us;
  return message;
}

Message page() {
  Message message;
  message.body.Set(wire::InstancePageT{});
  return message;
}

std::uint32_t number(const Message& message) {
  const wire::TileReplyT* reply = message.body.AsTileReply();
  return reply ? reply->request_id : 0;
}

std::vector<std::uint32_t> take(UploadQueue& queue, std::vector<Message> arrived,
                                std::int64_t now_us = 0) {
  const auto cost = [](const Message& m) { return m.body.AsTileReply() ? kCost : std::size_t{0}; };
  const auto first = [](const Message& m) { return number(m) >= kFirstImage; };
  std::vector<std::uint32_t> out;
  for (const Message& m : queue.take(std::move(arrived), now_us, cost, first)) {
    out.push_back(number(m));
  }
  return out;
}

template <typename... Messages>
std::vector<Message> list(Messages... messages) {
  std::vector<Message> out;
  (out.push_back(std::move(messages)), ...);
  return out;
}

using Numbers = std::vector<std::uint32_t>;

TEST(UploadQueue, WithinTheBudgetAllIsTakenInOrder) {
  UploadQueue queue(3 * kCost);
  EXPECT_EQ(take(queue, list(tile(1), page(), tile(kFirstImage), tile(2))),
            (Numbers{1, 0, kFirstImage, 2}));
  EXPECT_TRUE(queue.empty());
  EXPECT_EQ(queue.counts().frames_over_budget, 0u);
}

TEST(UploadQueue, BeyondItFirstImagesComeFirstAndPagesNeverWait) {
  UploadQueue queue(2 * kCost);
  EXPECT_EQ(take(queue, list(tile(1), tile(2), page(), tile(kFirstImage))),
            (Numbers{0, kFirstImage, 1}));
  EXPECT_FALSE(queue.empty());
  EXPECT_EQ(take(queue, list(tile(3), tile(4))), (Numbers{2, 3}));
  EXPECT_EQ(take(queue, {}), (Numbers{4}));
  EXPECT_TRUE(queue.empty());
  EXPECT_EQ(queue.counts().frames_over_budget, 2u);
}

TEST(UploadQueue, OneThatIsLargerThanTheBudgetIsTakenAlone) {
  UploadQueue queue(kCost / 2);
  EXPECT_EQ(take(queue, list(tile(1), tile(2))), (Numbers{1}));
  EXPECT_EQ(take(queue, {}), (Numbers{2}));
}

TEST(UploadQueue, WhatHasArrivedWhenIsKeptAndNeverGoesBack) {
  UploadQueue queue(2 * kCost);
  const auto cost = [](const Message&) { return kCost; };
  const auto first = [](const Message& m) { return number(m) >= kFirstImage; };
  std::int64_t latest = INT64_MIN;
  std::set<std::uint32_t> seen;
  for (std::int64_t now = 1000; now < 4000; now += 1000) {
    std::vector<Message> arrived;
    if (now == 1000)
      arrived = list(tile(1, 900), tile(2, 800), tile(3, 700), tile(kFirstImage, 50));
    for (const Message& m : queue.take(std::move(arrived), now, cost, first)) {
      EXPECT_GE(now - m.waited_us, latest);
      EXPECT_LE(now - m.waited_us, 950) << "long before it was taken";
      latest = now - m.waited_us;
      seen.insert(number(m));
    }
  }
  EXPECT_EQ(seen, (std::set<std::uint32_t>{1, 2, 3, kFirstImage}));
}

TEST(UploadQueue, AFloodIsNotKept) {
  UploadQueue queue(kCost);
  std::vector<Message> flood;
  for (std::uint32_t i = 1; i <= UploadQueue::kMostWaiting + 10; ++i) flood.push_back(tile(i));
  EXPECT_EQ(take(queue, std::move(flood)).size(), 10u);
}

TEST(UploadQueue, WhatWaitedOverALostConnectionIsGone) {
  UploadQueue queue(kCost);
  EXPECT_EQ(take(queue, list(tile(1), tile(2))), (Numbers{1}));
  queue.clear();
  EXPECT_TRUE(queue.empty());
  EXPECT_EQ(take(queue, list(tile(3))), (Numbers{3}));
}

TEST(UploadQueue, CountsFramesApart) {
  UploadQueue queue(kCost);
  take(queue, {});
  queue.uploaded(10, true);
  queue.uploaded(20, false);
  take(queue, {});
  queue.uploaded(25, true);
  EXPECT_EQ(queue.counts().tiles, 2u);
  EXPECT_EQ(queue.counts().bytes, 55u);
  EXPECT_EQ(queue.counts().largest_frame_bytes, 30u);
}

TEST(UploadQueue, ATileTakesAllItsPlanesAndAGutter) {
  EXPECT_EQ(tile_upload_bytes(8, 6, kLitTile), 10u * 8 * 5);
  EXPECT_EQ(tile_upload_bytes(8, 6, kRelitTile), 10u * 8 * 9);
  EXPECT_EQ(tile_upload_bytes(8, 6, kLayeredTile), 10u * 8 * 15) << "both layers, and both in one";
  EXPECT_EQ(tile_upload_bytes(8, 6, kShadowTile), 10u * 8);
  EXPECT_EQ(tile_upload_bytes(0, 0, kLitTile), 0u);
}

}  // namespace
}  // namespace mirage::test
