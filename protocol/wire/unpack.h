#pragma once
// Unpacks the slow parts of messages ahead of time. A link with a spare thread does it, so that the
// frame that takes a message only copies and uploads.

#include <vector>

#include "protocol/codec/atlas_planes.h"
#include "protocol/model/model.h"
#include "protocol/wire/message.h"

namespace mirage {

/// Unpacks the messages of a connection. It reads which images an alpha test uses from their pages,
/// because mip levels of those keep their coverage.
class MessageUnpacker {
 public:
  /// Unpacks a message: a tile becomes what read_unpacked_tile() takes, an image what
  /// read_unpacked_image() takes; the block of geometry and of reference frames is decompressed;
  /// colours of a view become RGBA. Other messages stay unchanged, and so does `payload_bytes`.
  /// Takes hostile bytes: sizes are checked against limits before anything is allocated. Errors:
  /// those of decoding the message.
  Result<void> unpack(Message& message);

 private:
  void note(const wire::ImagePageT& page);
  Result<Bytes> image_levels(const wire::ImageReplyT& reply, const Bytes& payload) const;
  Result<Bytes> unpacked(const Message& message) const;

  struct Known {
    float alpha_cutoff = 0;  ///< 0: no alpha test
    bool srgb = true;
  };
  std::vector<Known> images_;
};

/// A tile, and the same in the form that textures take.
struct UnpackedTile {
  Tile tile;
  AtlasPlanes planes;
};
/// Reads an unpacked tile. Errors kWireValue, kCodec: the message is not a whole one.
Result<UnpackedTile> read_unpacked_tile(const Message& message);

/// Reads an unpacked image of `size`. It is followed by its mip levels if an alpha test uses it
/// (`tested`). Error kCodec: the payload is of another size.
Result<std::vector<Image>> read_unpacked_image(const Bytes& payload, const glm::uvec2& size,
                                               bool srgb, bool tested);

}  // namespace mirage
