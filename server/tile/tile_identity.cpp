#include "server/tile/tile_identity.h"

#include <openssl/sha.h>

#include <array>
#include <cstring>

#include "protocol/base/bytes.h"

namespace mirage {
namespace {

template <typename T>
void append(Bytes& out, const std::vector<T>& values) {
  const auto* const first = reinterpret_cast<const std::uint8_t*>(values.data());
  out.insert(out.end(), first, first + values.size() * sizeof(T));
}

}  // namespace

TileId tile_identity(const TileKey& key, const ObjectLighting& lighting, const Lighting& world) {
  Bytes bytes = canonical_bytes(key);
  append(bytes, lighting.canonical());
  append(bytes, canonical_values(world));
  std::array<std::uint8_t, SHA256_DIGEST_LENGTH> digest{};
  SHA256(bytes.data(), bytes.size(), digest.data());
  TileId id;
  std::memcpy(&id.low, digest.data(), sizeof(id.low));
  std::memcpy(&id.high, digest.data() + sizeof(id.low), sizeof(id.high));
  return id;
}

}  // namespace mirage
