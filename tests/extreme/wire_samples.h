#pragma once
// Wire samples: valid bytes of every kind that a peer sends, and decoders that treat them as the
// programs do.

#include <functional>
#include <string>
#include <vector>

#include "protocol/codec/model_codec.h"
#include "protocol/wire/message.h"

namespace mirage::extreme {

/// Bytes and a decoder for them.
struct WireSample {
  std::string name;
  Bytes bytes;
  /// Returns true if they are accepted. `not_finite` counts floats of the result that are NaN or
  /// infinite.
  std::function<bool(const Bytes& bytes, int& not_finite)> accepts;
};

/// Returns every message, every kind of tile, geometry, images. `data` is the folder of the
/// fuzzers' corpus. Throws std::runtime_error if a file is missing there.
std::vector<WireSample> wire_samples(const std::string& data);

/// Returns a file of the fuzzers' corpus, such as "tile/zstd_9x8". Throws std::runtime_error, which
/// becomes the outcome of the case, if it is missing.
Bytes corpus(const std::string& data, const std::string& name);

/// Returns the FNV-1a hash.
std::uint64_t hash_of(const Bytes& bytes);

}  // namespace mirage::extreme
