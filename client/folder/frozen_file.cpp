#include "client/folder/frozen_file.h"

#include <xxhash.h>

#include <cstdio>
#include <cstring>

#include "protocol/base/byte_stream.h"
#include "protocol/base/limits.h"
#include "protocol/codec/tile_codec.h"

namespace mirage {
namespace {

constexpr char kMagic[8] = {'M', 'I', 'R', 'F', 'R', 'Z', '0', '1'};
constexpr std::size_t kMaxOpeningMessages = 1u << 16;

std::string folder_of(const char* kind, std::uint64_t revision) {
  char text[64];
  std::snprintf(text, sizeof(text), "v1/%s/%016llx/", kind,
                static_cast<unsigned long long>(revision));
  return text;
}

Error damaged(const char* what) { return make_error(ErrorId::kWireMalformed, what); }

}  // namespace

std::uint64_t frozen_hash(const Bytes& file) { return XXH3_64bits(file.data(), file.size()); }

std::string frozen_tile_name(std::uint64_t revision, const TileAddress& address) {
  return folder_of("tile", revision) + address.text();
}

std::string frozen_asset_name(std::uint64_t revision, bool image, std::uint32_t index,
                              std::uint8_t level) {
  return folder_of(image ? "image" : "mesh", revision) + std::to_string(index) + "." +
         std::to_string(level);
}

TileAddress address_of(const wire::FrozenTile& tile) {
  return {tile.instance(),
          {tile.view_level(), tile.view_x(), tile.view_y()},
          {tile.distance_level(), tile.distance_index()},
          tile.size_class(),
          tile.channels(),
          tile.phase(),
          static_cast<TileCodec>(tile.codec())};
}

Bytes encode_frozen(const std::vector<Bytes>& messages) {
  ByteWriter body;
  body.put(static_cast<std::uint32_t>(messages.size()));
  for (const Bytes& message : messages) {
    body.put(static_cast<std::uint32_t>(message.size()));
    body.put_bytes(message.data(), message.size());
  }
  const Bytes packed = compress_block(body.bytes.data(), body.bytes.size());
  ByteWriter out;
  out.put_bytes(kMagic, sizeof(kMagic));
  out.put(frozen_hash(packed));
  out.put(static_cast<std::uint64_t>(body.bytes.size()));
  out.put_bytes(packed.data(), packed.size());
  return out.bytes;
}

Result<std::vector<Bytes>> decode_frozen(const Bytes& file) {
  ByteReader head(file.data(), file.size());
  const std::uint8_t* const magic = head.take(sizeof(kMagic));
  const auto hash = head.get<std::uint64_t>();
  const auto size = head.get<std::uint64_t>();
  if (head.failed()) return damaged("the file is cut");
  if (std::memcmp(magic, kMagic, sizeof(kMagic) - 2) != 0) return damaged("it is another file");
  if (std::memcmp(magic, kMagic, sizeof(kMagic)) != 0) {
    return make_error(ErrorId::kWireVersion, "the folder is of another version");
  }
  const Bytes packed(head.at(), head.at() + head.left());
  if (frozen_hash(packed) != hash) return damaged("the file is cut or damaged");
  if (size > limits::kMaxTransferBytes) {
    return make_error(ErrorId::kWireLimit, "the file describes more than a client takes");
  }
  Result<Bytes> body =
      decompress_block(packed.data(), packed.size(), static_cast<std::size_t>(size));
  if (!body) return body.error();
  ByteReader in(body->data(), body->size());
  const auto count = in.get<std::uint32_t>();
  if (count > kMaxOpeningMessages) {
    return make_error(ErrorId::kWireLimit, "the file has more parts than a client takes");
  }
  std::vector<Bytes> out;
  for (std::uint32_t i = 0; i < count; ++i) {
    const auto bytes = in.get<std::uint32_t>();
    const std::uint8_t* const from = in.take(bytes);
    if (!from) return damaged("the file is cut");
    out.emplace_back(from, from + bytes);
  }
  return out;
}

}  // namespace mirage
