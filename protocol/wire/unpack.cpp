#include "protocol/wire/unpack.h"

#include <algorithm>

#include "protocol/base/limits.h"
#include "protocol/codec/image_codec.h"
#include "protocol/codec/mip_chain.h"
#include "protocol/codec/tile_codec.h"
#include "protocol/wire/conversions.h"
#include "protocol/wire/view_codec.h"

namespace mirage {
namespace {

Result<Bytes> tile_planes(const wire::TileReplyT& reply, const Bytes& payload) {
  Result<Tile> tile = tile_from_fields(reply);
  if (!tile) return tile.error();
  const Result<void> decoded = decode_tile_planes(payload.data(), payload.size(),
                                                  static_cast<TileCodec>(reply.codec), *tile);
  if (!decoded) return decoded.error();
  Bytes out = raw_tile_planes(*tile);
  append_atlas_planes(atlas_planes(*tile), out);
  return out;
}

Result<Bytes> block(const Bytes& payload, std::size_t raw_bytes) {
  if (raw_bytes == payload.size()) return payload;
  if (raw_bytes > limits::kMaxTransferBytes) {
    return make_error(ErrorId::kWireLimit, "a reply is larger than any that is taken");
  }
  return decompress_block(payload.data(), payload.size(), raw_bytes);
}

}  // namespace

void MessageUnpacker::note(const wire::ImagePageT& page) {
  const std::size_t end = std::size_t{page.first} + page.images.size();
  if (end > limits::kMaxImages) return;  // no scene takes such a page
  images_.resize(std::max(images_.size(), end));
  for (std::size_t i = 0; i < page.images.size(); ++i) {
    images_[page.first + i] = {page.images[i].alpha_cutoff(), page.images[i].srgb()};
  }
}

Result<Bytes> MessageUnpacker::image_levels(const wire::ImageReplyT& reply,
                                            const Bytes& payload) const {
  const std::optional<glm::uvec2> size = encoded_image_size(payload.data(), payload.size());
  if (!size) return make_error(ErrorId::kCodec, "an image is damaged or larger than any level");
  const Known known = reply.image < images_.size() ? images_[reply.image] : Known{};
  const Result<Image> image = decode_image(payload.data(), payload.size(), *size, known.srgb);
  if (!image) return image.error();
  Bytes out = image->rgba;
  if (known.alpha_cutoff <= 0) return out;
  for (const Image& mip : alpha_preserving_mips(*image, known.alpha_cutoff)) {
    out.insert(out.end(), mip.rgba.begin(), mip.rgba.end());
  }
  return out;
}

Result<Bytes> MessageUnpacker::unpacked(const Message& message) const {
  const wire::BodyUnion& body = message.body;
  if (const wire::TileReplyT* tile = body.AsTileReply()) return tile_planes(*tile, message.payload);
  if (const wire::MeshReplyT* mesh = body.AsMeshReply()) {
    return block(message.payload, mesh->raw_bytes);
  }
  if (const auto* image = body.AsImageReply()) return image_levels(*image, message.payload);
  if (const wire::ViewReplyT* view = body.AsViewReply()) {
    return view_planes(*view, message.payload);
  }
  if (const wire::ReferenceReplyT* reference = body.AsReferenceReply()) {
    return block(message.payload, reference->raw_bytes);
  }
  return message.payload;
}

Result<void> MessageUnpacker::unpack(Message& message) {
  if (const auto* page = message.body.AsImagePage()) note(*page);
  Result<Bytes> payload = unpacked(message);
  if (!payload) return payload.error();
  message.payload = payload.take();
  message.unpacked = true;
  return {};
}

Result<UnpackedTile> read_unpacked_tile(const Message& message) {
  Result<Tile> tile = tile_from_fields(*message.body.AsTileReply());
  if (!tile) return tile.error();
  const Bytes& payload = message.payload;
  const std::size_t planes_bytes = atlas_plane_bytes(tile->crop, tile->channels);
  if (planes_bytes > payload.size()) {
    return make_error(ErrorId::kCodec, "an unpacked tile ends too early");
  }
  const std::size_t raw_bytes = payload.size() - planes_bytes;
  const Result<void> decoded =
      decode_tile_planes(payload.data(), raw_bytes, TileCodec::kRaw, *tile);
  if (!decoded) return decoded.error();
  Result<AtlasPlanes> planes =
      read_atlas_planes(payload.data() + raw_bytes, planes_bytes, tile->crop, tile->channels);
  if (!planes) return planes.error();
  return UnpackedTile{tile.take(), planes.take()};
}

Result<std::vector<Image>> read_unpacked_image(const Bytes& payload, const glm::uvec2& size,
                                               bool srgb, bool tested) {
  std::vector<Image> levels;
  std::size_t read = 0;
  glm::uvec2 level = size;
  while (read < payload.size()) {
    const std::size_t bytes = std::size_t{level.x} * level.y * 4;
    if (bytes > payload.size() - read) break;
    const auto at = payload.begin() + static_cast<std::ptrdiff_t>(read);
    levels.push_back({level.x, level.y, srgb, Bytes(at, at + static_cast<std::ptrdiff_t>(bytes))});
    read += bytes;
    if (!tested || level == glm::uvec2(1)) break;
    level = glm::max(level / 2u, glm::uvec2(1));
  }
  const bool whole = !levels.empty() && read == payload.size() &&
                     (!tested || (levels.back().width == 1 && levels.back().height == 1));
  if (!whole) return make_error(ErrorId::kCodec, "an image is not of the size it was asked for");
  return levels;
}

}  // namespace mirage
