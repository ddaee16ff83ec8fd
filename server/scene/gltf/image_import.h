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
#include "server/scene/gltf/tally.h"
#include "server/scene/workers.h"

namespace mirage::gltf {

class ImageImporter {
 public:
  ImageImporter(const Document& document, Tally& tally) : document_(document), tally_(tally) {}

  /// Place in the scene's list of a glTF image. Colour and data need different decoding, so an
  /// image used for both is there twice.
  std::int32_t index_of(int source, bool srgb);
  /// Decodes all that were asked for; unreadable ones become white with a warning. Error
  /// kSceneLimit when one, or all together, are too large.
  Result<std::vector<Image>> take(const Workers& workers);
  /// After take(): whether the image at this place is what the file holds.
  bool readable(std::int32_t place) const;

 private:
  struct Wanted {
    int source = 0;
    bool srgb = true;
    bool readable = false;
    std::int32_t same = -1;  ///< the place of the same image decoded the other way
  };
  /// Encoded bytes, in the document or read into `owned`. Errors: kSceneUri, kSceneMissing,
  /// kSceneLimit.
  Result<std::span<const std::uint8_t>> bytes_of(int source,
                                                 std::vector<std::uint8_t>& owned) const;
  Result<void> judge(Wanted& wanted, std::uint64_t& pixels);
  Result<void> leave_out(Wanted& wanted, const Error& error);

  const Document& document_;
  Tally& tally_;
  std::vector<Wanted> wanted_;
  std::map<std::pair<int, bool>, std::int32_t> index_;
};

}  // namespace mirage::gltf
