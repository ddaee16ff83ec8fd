#pragma once
// Valid bytes of every kind a peer sends, and what decoding them as the programs do comes to.

#include <functional>
#include <string>
#include <vector>

#include "protocol/codec/model_codec.h"
#include "protocol/wire/message.h"

namespace mirage::extreme {

/// Bytes, and a decoder for them.
struct WireSample {
  std::string name;
  Bytes bytes;
  /// True when they are accepted. `not_finite` counts floats of the result that are NaN or
  /// infinite.
  std::function<bool(const Bytes& bytes, int& not_finite)> accepts;
};

/// Every message, every kind of tile, geometry, images.
std::vector<WireSample> wire_samples();

/// A file of the fuzzers' corpus, "tile/zstd_9x8".
Bytes corpus(const std::string& name);

/// FNV-1a.
std::uint64_t hash_of(const Bytes& bytes);

}  // namespace mirage::extreme
