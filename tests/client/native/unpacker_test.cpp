// The unpacker of a link: order, damage, and an end with messages still waiting.
#include "client/native/unpacker.h"

#include <gtest/gtest.h>

#include <condition_variable>
#include <mutex>

#include "protocol/codec/tile_codec.h"
#include "protocol/wire/conversions.h"
#include "protocol/wire/message.h"

namespace mirage::test {
namespace {

constexpr std::uint32_t kEdge = 64;

Unpacker::Received tile_reply(std::uint32_t id, bool damaged = false) {
  Tile tile;
  tile.edge = kEdge;
  tile.crop = {0, 0, kEdge, kEdge};
  tile.rgba.assign(tile.crop.area() * 4, static_cast<std::uint8_t>(id));
  tile.depth.assign(tile.crop.area(), 7);
  wire::TileReplyT reply;
  set_tile_fields(tile, reply);
  reply.request_id = id;
  reply.codec = static_cast<std::uint8_t>(TileCodec::kZstd);
  Unpacker::Received out;
  out.generation = 3;
  out.message.payload = encode_tile_planes(tile, TileCodec::kZstd);
  if (damaged) out.message.payload.resize(out.message.payload.size() / 2);
  out.message.payload_bytes = out.message.payload.size();
  out.message.body.Set(std::move(reply));
  return out;
}

/// Keeps what an unpacker tells.
struct Told {
  std::mutex mutex;
  std::condition_variable changed;
  std::vector<std::uint32_t> ids, damaged;
  std::size_t unpacked_bytes = 0;

  Unpacker::Hooks hooks() {
    return {[this](Unpacker::Received r) {
              const std::lock_guard<std::mutex> lock(mutex);
              ids.push_back(r.message.body.AsTileReply()->request_id);
              unpacked_bytes += r.message.unpacked ? r.message.payload.size() : 0;
              changed.notify_all();
            },
            [this](std::uint32_t generation, const Error&) {
              const std::lock_guard<std::mutex> lock(mutex);
              damaged.push_back(generation);
              changed.notify_all();
            }};
  }
  bool wait(std::size_t count) {
    std::unique_lock<std::mutex> lock(mutex);
    return changed.wait_for(lock, std::chrono::seconds(60),
                            [&] { return ids.size() + damaged.size() >= count; });
  }
};

TEST(NativeUnpacker, MessagesComeOutRawAndInOrder) {
  Told told;
  Unpacker unpacker(told.hooks());
  constexpr std::uint32_t kCount = 50;
  std::vector<std::uint32_t> expected;
  for (std::uint32_t i = 0; i < kCount; ++i) {
    unpacker.add(tile_reply(i));
    expected.push_back(i);
  }
  ASSERT_TRUE(told.wait(kCount));
  EXPECT_EQ(told.ids, expected);
  constexpr std::size_t kPlain = std::size_t{kEdge} * kEdge * 5;  // colour and depth
  constexpr std::size_t kPlanes = std::size_t{kEdge + 2} * (kEdge + 2) * 5;
  EXPECT_EQ(told.unpacked_bytes, kCount * (kPlain + kPlanes));
}

TEST(NativeUnpacker, DamageIsToldWithItsConnectionAndTheRestGoesOn) {
  Told told;
  Unpacker unpacker(told.hooks());
  unpacker.add(tile_reply(1));
  unpacker.add(tile_reply(2, true));
  unpacker.add(tile_reply(3));
  ASSERT_TRUE(told.wait(3));
  EXPECT_EQ(told.ids, (std::vector<std::uint32_t>{1, 3}));
  EXPECT_EQ(told.damaged, std::vector<std::uint32_t>{3});
}

TEST(NativeUnpacker, AnEndDoesNotWaitForAllThatIsLeft) {
  constexpr int kCount = 100;
  int told = 0;
  {
    const auto slow = [&](const Unpacker::Received&) {
      ++told;
      std::this_thread::sleep_for(std::chrono::milliseconds(20));
    };
    Unpacker unpacker({slow, nullptr});
    for (std::uint32_t i = 0; i < kCount; ++i) unpacker.add(tile_reply(i));
  }
  EXPECT_LT(told, kCount);
}

}  // namespace
}  // namespace mirage::test
