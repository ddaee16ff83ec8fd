#pragma once
// Blocks of ground as bytes.

#include "protocol/base/bytes.h"
#include "protocol/base/result.h"
#include "protocol/model/ground.h"

namespace mirage {

/// Returns the block without its number: base and step, counts and floors; compressed.
Bytes encode_ground(const GroundBlock& block);
/// Reads a block from hostile bytes; `raw_bytes` is its size uncompressed. The number is left 0.
/// Errors: kWireLimit if it is larger than a block can be; kCodec if it is damaged, or if heights
/// are not finite or floors do not rise.
Result<GroundBlock> decode_ground(const Bytes& bytes, std::size_t raw_bytes);
/// Returns the size of a block before it is compressed.
std::size_t ground_bytes(const GroundBlock& block);

}  // namespace mirage
