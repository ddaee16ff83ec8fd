#include "protocol/codec/ground_codec.h"

#include <cmath>
#include <cstring>
#include <numeric>

#include "protocol/codec/tile_codec.h"

namespace mirage {
namespace {

constexpr std::size_t kHead = 2 * sizeof(double);
constexpr std::size_t kCellCount = std::size_t{kGroundCells} * kGroundCells;

// True if the floors of each cell rise.
bool rising(const GroundBlock& block) {
  std::size_t at = 0;
  for (const std::uint8_t count : block.counts) {
    for (std::size_t i = 1; i < count; ++i) {
      if (block.floors[at + i] <= block.floors[at + i - 1]) return false;
    }
    at += count;
  }
  return true;
}

}  // namespace

std::size_t ground_bytes(const GroundBlock& block) {
  return kHead + kCellCount + block.floors.size() * sizeof(std::uint16_t);
}

Bytes encode_ground(const GroundBlock& block) {
  Bytes raw(ground_bytes(block));
  std::memcpy(raw.data(), &block.base_m, sizeof(double));
  std::memcpy(raw.data() + sizeof(double), &block.step_m, sizeof(double));
  std::memcpy(raw.data() + kHead, block.counts.data(), kCellCount);
  if (!block.floors.empty()) {
    std::memcpy(raw.data() + kHead + kCellCount, block.floors.data(),
                block.floors.size() * sizeof(std::uint16_t));
  }
  return compress_block(raw.data(), raw.size());
}

Result<GroundBlock> decode_ground(const Bytes& bytes, std::size_t raw_bytes) {
  if (raw_bytes > kHead + kCellCount + kMostFloors * sizeof(std::uint16_t)) {
    return make_error(ErrorId::kWireLimit, "more floors than a block of ground has");
  }
  const auto damaged = [] { return make_error(ErrorId::kCodec, "a damaged block of ground"); };
  if (raw_bytes < kHead + kCellCount) return damaged();
  const Result<Bytes> raw = decompress_block(bytes.data(), bytes.size(), raw_bytes);
  if (!raw) return raw.error();
  GroundBlock out;
  std::memcpy(&out.base_m, raw->data(), sizeof(double));
  std::memcpy(&out.step_m, raw->data() + sizeof(double), sizeof(double));
  const std::uint8_t* const counts = raw->data() + kHead;
  out.counts.assign(counts, counts + kCellCount);
  const std::size_t floors = std::accumulate(out.counts.begin(), out.counts.end(), std::size_t{0});
  if (ground_bytes(out) + floors * sizeof(std::uint16_t) != raw_bytes) return damaged();
  out.floors.resize(floors);
  if (floors > 0) {
    std::memcpy(out.floors.data(), counts + kCellCount, floors * sizeof(std::uint16_t));
  }
  const bool sound = std::isfinite(out.base_m) && std::isfinite(out.step_m) && out.step_m >= 0;
  if (!sound || !rising(out)) return damaged();
  return out;
}

}  // namespace mirage
