// Framing: header bytes, chunks, and what a peer must not do with them.
#include "protocol/wire/wire.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <random>

namespace mirage::test {
namespace {

Bytes make_message(std::size_t control, std::size_t payload) {
  Bytes bytes(kWireHeaderBytes + control + payload);
  PacketHeader header;
  header.control_bytes = static_cast<std::uint32_t>(control);
  header.payload_bytes = static_cast<std::uint32_t>(payload);
  for (std::size_t i = kWireHeaderBytes; i < bytes.size(); ++i) {
    bytes[i] = static_cast<std::uint8_t>(i * 7 + i / 256);
  }
  write_packet_header(header, bytes.data());
  return bytes;
}

Bytes make_chunk(std::uint32_t id, std::uint32_t total, std::uint32_t offset, const Bytes& data) {
  Bytes bytes(kWireHeaderBytes + kChunkPrefixBytes);
  PacketHeader header;
  header.kind = PacketKind::kChunk;
  header.payload_bytes = static_cast<std::uint32_t>(kChunkPrefixBytes + data.size());
  write_packet_header(header, bytes.data());
  const std::uint32_t words[] = {id, total, offset};
  for (std::size_t i = 0; i < 12; ++i) {
    bytes[kWireHeaderBytes + i] = static_cast<std::uint8_t>(words[i / 4] >> (8 * (i % 4)));
  }
  bytes.insert(bytes.end(), data.begin(), data.end());
  return bytes;
}

void expect_error(const Result<std::optional<Bytes>>& result, ErrorId id) {
  ASSERT_FALSE(result);
  EXPECT_EQ(result.error().id, id) << result.error().line();
}

ErrorId header_error(const Bytes& bytes) {
  const Result<PacketHeader> header = read_packet_header(bytes.data(), bytes.size());
  return header ? ErrorId::kInternal : header.error().id;
}

TEST(ProtocolWire, HeaderGoldenBytes) {
  PacketHeader header;
  header.control_bytes = 0x01020304;
  header.payload_bytes = 0xa1b2c3d4;
  std::uint8_t out[16];
  write_packet_header(header, out);
  const std::uint8_t expected[16] = {'M',  'R',  5,    1,    0x04, 0x03, 0x02, 0x01,
                                     0xd4, 0xc3, 0xb2, 0xa1, 0,    0,    0,    0};
  EXPECT_TRUE(std::equal(out, out + 16, expected));
}

TEST(ProtocolWire, HeaderIsChecked) {
  const Bytes good = make_message(8, 5);
  const Result<PacketHeader> header = read_packet_header(good.data(), good.size());
  ASSERT_TRUE(header);
  EXPECT_EQ(header->control_bytes, 8u);
  EXPECT_EQ(header->payload_bytes, 5u);
  for (std::size_t n = 0; n < good.size(); ++n) {
    EXPECT_EQ(header_error({good.begin(), good.begin() + static_cast<std::ptrdiff_t>(n)}),
              ErrorId::kWireMalformed);
  }
  Bytes longer = good;
  longer.push_back(0);
  EXPECT_EQ(header_error(longer), ErrorId::kWireMalformed);
  const auto changed = [&](std::size_t at, int value) {
    Bytes bytes = good;
    bytes[at] = static_cast<std::uint8_t>(value);
    return header_error(bytes);
  };
  EXPECT_EQ(changed(0, 'm'), ErrorId::kWireMalformed);
  EXPECT_EQ(changed(1, 'r'), ErrorId::kWireMalformed);
  EXPECT_EQ(changed(2, 0), ErrorId::kWireVersion);
  EXPECT_EQ(changed(2, 1), ErrorId::kWireVersion);
  EXPECT_EQ(changed(2, 2), ErrorId::kWireVersion);
  EXPECT_EQ(changed(2, 3), ErrorId::kWireVersion);
  EXPECT_EQ(changed(2, 4), ErrorId::kWireVersion);
  EXPECT_EQ(changed(2, 6), ErrorId::kWireVersion);
  EXPECT_EQ(changed(3, 0), ErrorId::kWireMalformed);
  EXPECT_EQ(changed(3, 3), ErrorId::kWireMalformed);
  EXPECT_EQ(changed(12, 1), ErrorId::kWireMalformed);
  EXPECT_EQ(changed(15, 1), ErrorId::kWireMalformed);
}

TEST(ProtocolWire, LengthsDoNotWrapAround) {
  // control + payload + 16 is 2^32 + the true size: 32-bit sums would agree.
  Bytes bytes = make_message(8, 5);
  PacketHeader header;
  header.control_bytes = 0xfffffff0u;
  header.payload_bytes = 0x10u + 13u;
  write_packet_header(header, bytes.data());
  EXPECT_EQ(header_error(bytes), ErrorId::kWireMalformed);
}

TEST(ProtocolWire, SmallMessagesTravelWhole) {
  const Bytes message = make_message(100, 50);
  const auto packets = split_into_packets(message, 1);
  ASSERT_EQ(packets.size(), 1u);
  PacketAssembler assembler(limits::kMaxTransferBytes);
  const auto whole = assembler.accept(packets[0].data(), packets[0].size());
  ASSERT_TRUE(whole && *whole);
  EXPECT_EQ(**whole, message);
}

TEST(ProtocolWire, SplitAndReassemble) {
  for (const std::size_t payload : {limits::kMaxMessageBytes - 1016, limits::kMaxMessageBytes,
                                    limits::kChunkBytes * 5 - 1016, std::size_t{1'000'001}}) {
    const Bytes message = make_message(1000, payload);
    const auto packets = split_into_packets(message, 9);
    PacketAssembler assembler(limits::kMaxTransferBytes);
    for (std::size_t i = 0; i < packets.size(); ++i) {
      ASSERT_LE(packets[i].size(), limits::kMaxMessageBytes);
      const auto whole = assembler.accept(packets[i].data(), packets[i].size());
      ASSERT_TRUE(whole);
      ASSERT_EQ(whole->has_value(), i + 1 == packets.size());
      if (*whole) {
        ASSERT_EQ(**whole, message);
      }
    }
  }
}

TEST(ProtocolWire, InterleavedTransfers) {
  PacketAssembler assembler(limits::kMaxTransferBytes);
  std::vector<Bytes> messages;
  std::vector<std::vector<Bytes>> frames;
  for (std::uint32_t id = 0; id < limits::kMaxOpenTransfers; ++id) {
    messages.push_back(make_message(8, 600'000 + id * 1000));
    frames.push_back(split_into_packets(messages.back(), id));
  }
  for (int round = 0; round < 2; ++round) {  // ids may be used again
    std::size_t complete = 0;
    for (std::size_t i = 0; i < frames[0].size(); ++i) {
      for (std::size_t t = 0; t < frames.size(); ++t) {
        const auto whole = assembler.accept(frames[t][i].data(), frames[t][i].size());
        ASSERT_TRUE(whole);
        if (!*whole) continue;
        EXPECT_EQ(**whole, messages[t]);
        ++complete;
      }
    }
    EXPECT_EQ(complete, frames.size());
  }
}

TEST(ProtocolWire, OverLimitIsRefused) {
  PacketAssembler assembler(1000);
  const Bytes at_limit = make_chunk(1, 1000, 0, Bytes(10));
  EXPECT_TRUE(assembler.accept(at_limit.data(), at_limit.size()));
  const Bytes over = make_chunk(2, 1001, 0, Bytes(10));
  expect_error(assembler.accept(over.data(), over.size()), ErrorId::kWireLimit);
  const Bytes huge = make_chunk(2, 0xffffffffu, 0, Bytes(10));
  expect_error(assembler.accept(huge.data(), huge.size()), ErrorId::kWireLimit);
  const Bytes large = make_message(8, limits::kMaxMessageBytes);
  expect_error(assembler.accept(large.data(), large.size()), ErrorId::kWireLimit);
}

TEST(ProtocolWire, ChunksMustContinueTheirMessage) {
  const auto second = [](std::uint32_t total, std::uint32_t offset, std::size_t n) {
    PacketAssembler assembler(1000);
    const Bytes first = make_chunk(1, 100, 0, Bytes(10));
    EXPECT_TRUE(assembler.accept(first.data(), first.size()));
    const Bytes chunk = make_chunk(1, total, offset, Bytes(n));
    const auto result = assembler.accept(chunk.data(), chunk.size());
    return result ? ErrorId::kInternal : result.error().id;
  };
  EXPECT_EQ(second(100, 10, 10), ErrorId::kInternal);       // the good one
  EXPECT_EQ(second(100, 9, 10), ErrorId::kWireMalformed);   // overlap
  EXPECT_EQ(second(100, 0, 10), ErrorId::kWireMalformed);   // again
  EXPECT_EQ(second(100, 11, 10), ErrorId::kWireMalformed);  // gap
  EXPECT_EQ(second(101, 10, 10), ErrorId::kWireMalformed);  // other total
  EXPECT_EQ(second(100, 10, 91), ErrorId::kWireMalformed);  // past the end
  PacketAssembler assembler(1000);
  const Bytes late = make_chunk(1, 100, 5, Bytes(10));
  expect_error(assembler.accept(late.data(), late.size()), ErrorId::kWireMalformed);
  const Bytes empty = make_chunk(2, 100, 0, {});
  expect_error(assembler.accept(empty.data(), empty.size()), ErrorId::kWireMalformed);
  // More bytes than announced are refused even if they would make a whole message.
  const Bytes more = make_chunk(4, 39, 0, make_message(8, 16));
  expect_error(assembler.accept(more.data(), more.size()), ErrorId::kWireMalformed);
  const Bytes none = make_chunk(3, 0, 0, Bytes(1));
  expect_error(assembler.accept(none.data(), none.size()), ErrorId::kWireMalformed);
}

TEST(ProtocolWire, TooManyOpenTransfers) {
  PacketAssembler assembler(1000);
  for (std::uint32_t id = 0; id < limits::kMaxOpenTransfers; ++id) {
    const Bytes chunk = make_chunk(id, 100, 0, Bytes(10));
    ASSERT_TRUE(assembler.accept(chunk.data(), chunk.size()));
  }
  const Bytes chunk = make_chunk(99, 100, 0, Bytes(10));
  expect_error(assembler.accept(chunk.data(), chunk.size()), ErrorId::kWireLimit);
}

TEST(ProtocolWire, WhatIsAssembledMustBeAMessage) {
  PacketAssembler assembler(1000);
  const Bytes noise = make_chunk(1, 40, 0, Bytes(40, 7));
  expect_error(assembler.accept(noise.data(), noise.size()), ErrorId::kWireMalformed);
  const Bytes nested = make_chunk(1, 38, 0, make_chunk(2, 10, 0, Bytes(10)));
  expect_error(assembler.accept(nested.data(), nested.size()), ErrorId::kWireMalformed);
}

TEST(ProtocolWire, FlippedBitsNeverCrash) {
  const auto packets = split_into_packets(make_message(8, 300'000), 3);
  std::mt19937 random(4);
  for (int i = 0; i < 1000; ++i) {
    PacketAssembler assembler(limits::kMaxInboundTransferBytes);
    for (Bytes frame : packets) {
      const std::size_t head = kWireHeaderBytes + kChunkPrefixBytes;
      frame[random() % head] ^= static_cast<std::uint8_t>(1u << random() % 8);
      const auto result = assembler.accept(frame.data(), frame.size());
      if (!result) break;
    }
  }
}

}  // namespace
}  // namespace mirage::test
