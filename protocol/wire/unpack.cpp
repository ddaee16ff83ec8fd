#include "protocol/wire/unpack.h"

#include "protocol/codec/image_codec.h"
#include "protocol/wire/view_codec.h"

namespace mirage {
namespace {

Result<Bytes> tile_planes(const wire::TileReplyT& reply, const Bytes& payload) {
  Result<Tile> tile = tile_from_fields(reply);
  if (!tile) return tile.error();
  const Result<void> decoded = decode_tile_planes(payload.data(), payload.size(),
                                                  static_cast<TileCodec>(reply.codec), *tile);
  if (!decoded) return decoded.error();
  return raw_tile_planes(*tile);
}

Result<Bytes> image_texels(const Bytes& payload) {
  const std::optional<glm::uvec2> size = encoded_image_size(payload.data(), payload.size());
  if (!size) return make_error(ErrorId::kCodec, "an image is damaged or larger than any level");
  Result<Image> image = decode_image(payload.data(), payload.size(), *size, true);
  if (!image) return image.error();
  return std::move(image->rgba);
}

Result<Bytes> block(const Bytes& payload, std::size_t raw_bytes) {
  if (raw_bytes == payload.size()) return payload;
  if (raw_bytes > limits::kMaxTransferBytes) {
    return make_error(ErrorId::kWireLimit, "a reply is larger than any that is taken");
  }
  return decompress_block(payload.data(), payload.size(), raw_bytes);
}

Result<Bytes> unpacked(const Message& message) {
  const wire::BodyUnion& body = message.body;
  if (const wire::TileReplyT* tile = body.AsTileReply()) return tile_planes(*tile, message.payload);
  if (const wire::MeshReplyT* mesh = body.AsMeshReply()) {
    return block(message.payload, mesh->raw_bytes);
  }
  if (body.AsImageReply()) return image_texels(message.payload);
  if (const wire::ViewReplyT* view = body.AsViewReply()) {
    return view_planes(*view, message.payload);
  }
  if (const wire::ReferenceReplyT* reference = body.AsReferenceReply()) {
    return block(message.payload, reference->raw_bytes);
  }
  return message.payload;
}

}  // namespace

Result<void> unpack(Message& message) {
  Result<Bytes> payload = unpacked(message);
  if (!payload) return payload.error();
  message.payload = payload.take();
  message.unpacked = true;
  return {};
}

}  // namespace mirage
