#pragma once
// The images that a scene's materials use: numbered when they are first asked for, decoded
// together at the end.

#include <cstdint>
#include <map>
#include <utility>
#include <vector>

#include "protocol/model.h"
#include "protocol/result.h"
#include "server/scene/gltf/document.h"
#include "server/scene/gltf/image_size.h"
#include "server/scene/gltf/tally.h"
#include "server/scene/workers.h"

namespace mirage::gltf {

class ImageImporter {
 public:
  ImageImporter(const Document& document, Tally& tally) : document_(document), tally_(tally) {}

  /// Place in the scene's list of a glTF image. Colour and data need different decoding, so an
  /// image used for both is there twice.
  std::int32_t index_of(int source, bool srgb);
  /// Decodes all that were asked for; unreadable ones become white with a warning, and so many
  /// pixels that they do not fit are reduced with another. Error kSceneLimit when one cannot be
  /// reduced while it is decoded, or all together take too long.
  Result<std::vector<Image>> take(const Workers& workers);
  /// After take(): whether the image at this place is what the file holds.
  bool readable(std::int32_t place) const;

 private:
  struct Wanted {
    int source = 0;
    bool srgb = true;
    bool readable = false;
    std::int32_t same = -1;  ///< the place of the same image decoded the other way
    ImageHeader header = {};
    std::uint64_t uses = 1;  ///< how often it lies in memory: `same` of it count here
    int halvings = 0;

    std::uint64_t pixels() const;  ///< as decoded
    std::uint64_t cost() const;    ///< pixels in memory while it is decoded
  };
  /// Encoded bytes, in the document or read into `owned`. Errors: kSceneUri, kSceneMissing,
  /// kSceneLimit.
  Result<std::span<const std::uint8_t>> bytes_of(int source,
                                                 std::vector<std::uint8_t>& owned) const;
  Result<void> judge(Wanted& wanted);
  /// Halves the largest until all fit kMaxScenePixels. Error kSceneLimit: more to decode than
  /// kMaxDecodedPixels.
  Result<void> fit();
  /// Those from `begin` whose decoding fits into memory together: the end.
  std::size_t batch_end(std::size_t begin) const;
  Result<void> leave_out(Wanted& wanted, const Error& error);

  const Document& document_;
  Tally& tally_;
  std::vector<Wanted> wanted_;
  std::map<std::pair<int, bool>, std::int32_t> index_;
};

}  // namespace mirage::gltf
