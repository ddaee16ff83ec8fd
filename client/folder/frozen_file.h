#pragma once
// The files of a frozen folder: their names, their hashes, and the one that opens the folder.
//
//   frozen.bin                           what a server says first, and the catalogue of the rest
//   v1/tile/REVISION/ADDRESS             a tile, with the bytes of a server's address of that name
//   v1/mesh/REVISION/OBJECT.LEVEL        a level of geometry
//   v1/image/REVISION/IMAGE.LEVEL        a level of an image
//
// Each of the latter is one message of the wire, without request id and times.

#include <cstdint>
#include <string>
#include <vector>

#include "protocol/base/bytes.h"
#include "protocol/base/result.h"
#include "protocol/wire/message.h"
#include "protocol/wire/tile_address.h"

namespace mirage {

inline constexpr const char* kFrozenName = "frozen.bin";

/// Returns the hash of a file, as the catalogue has it.
std::uint64_t frozen_hash(const Bytes& file);

/// Return the names of files, relative to the folder, with '/' between parts.
std::string frozen_tile_name(std::uint64_t revision, const TileAddress& address);
std::string frozen_asset_name(std::uint64_t revision, bool image, std::uint32_t index,
                              std::uint8_t level);
TileAddress address_of(const wire::FrozenTile& tile);

/// Writes frozen.bin of whole messages: pages of the catalogue, the welcome, pages of the scene,
/// and the home view.
Bytes encode_frozen(const std::vector<Bytes>& messages);
/// Reads it from hostile bytes. Errors kWireMalformed, kWireVersion, kWireLimit.
Result<std::vector<Bytes>> decode_frozen(const Bytes& file);

}  // namespace mirage
