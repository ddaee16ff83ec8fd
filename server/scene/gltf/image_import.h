#pragma once
// The images that a scene's materials use: numbered when they are first asked for, decoded
// together at the end.

#include <cstdint>
#include <map>
#include <utility>
#include <vector>

#include "protocol/base/result.h"
#include "protocol/model/model.h"
#include "server/base/workers.h"
#include "server/scene/gltf/document.h"
#include "server/scene/gltf/image_size.h"
#include "server/scene/gltf/spec_gloss.h"
#include "server/scene/gltf/tally.h"

namespace mirage::gltf {

class ImageImporter {
 public:
  ImageImporter(const Document& document, Tally& tally) : document_(document), tally_(tally) {}

  /// Place in the scene's list of a glTF image. Colour and data need different decoding, so an
  /// image used for both is there twice.
  std::int32_t index_of(int source, bool srgb);
  /// Places of the two images that a pair of KHR_materials_pbrSpecularGlossiness becomes; -1: that
  /// one is 1 everywhere.
  struct Converted {
    std::int32_t base = -1;
    std::int32_t metal_rough = -1;
  };
  Converted converted(int diffuse, int specular_glossiness, const SpecGloss& factors);
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
    bool drawn = false;      ///< by itself, not only for what it is converted to
    bool made = false;       ///< by a conversion, not from the file
    ImageHeader header = {};
    std::uint64_t uses = 1;  ///< how often it lies in memory: `same` of it count here
    int halvings = 0;

    std::uint64_t pixels() const;  ///< as decoded
    std::uint64_t cost() const;    ///< pixels in memory while it is decoded
  };
  struct Conversion {
    std::int32_t diffuse = -1;  ///< places, -1: none
    std::int32_t specular = -1;
    SpecGloss factors;
    Converted to;
  };
  std::int32_t wanted_place(int source, bool srgb);
  /// Makes what conversions make, and drops what was only there for them.
  void convert(const Workers& workers, std::vector<Image>& images);
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
  std::vector<Conversion> conversions_;
  std::map<std::pair<int, bool>, std::int32_t> index_;
};

}  // namespace mirage::gltf
