#pragma once
// The images that a scene's materials use. They are numbered at their first use and decoded
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

  /// Returns the place of a glTF image in the scene's list. Colour and data are decoded
  /// differently, so an image used for both has two places.
  std::int32_t index_of(int source, bool srgb);
  /// Places of the two images made from a pair of KHR_materials_pbrSpecularGlossiness; -1: that
  /// image would be 1 everywhere.
  struct Converted {
    std::int32_t base = -1;
    std::int32_t metal_rough = -1;
  };
  Converted converted(int diffuse, int specular_glossiness, const SpecGloss& factors);
  /// Decodes all images in use. Unreadable ones become white, with a warning. If all together have
  /// too many pixels, they are reduced, with another warning. Error kSceneLimit: an image cannot be
  /// reduced while it is decoded, or all together take too long. Error kModule: nothing can be
  /// decoded here.
  Result<std::vector<Image>> take(const Workers& workers);
  /// True if the image at this place could be decoded; valid after take().
  bool readable(std::int32_t place) const;

 private:
  struct Wanted {
    int source = 0;
    bool srgb = true;
    bool readable = false;
    std::int32_t same = -1;  ///< place of the same image decoded the other way
    bool drawn = false;      ///< used itself, not only for a conversion
    bool made = false;       ///< by a conversion; it is not in the file
    ImageHeader header = {};
    std::uint64_t uses = 1;  ///< copies in memory, those of `same` included
    int halvings = 0;

    std::uint64_t pixels() const;  ///< as decoded
    std::uint64_t cost() const;    ///< pixels in memory while decoding
  };
  struct Conversion {
    std::int32_t diffuse = -1;  ///< places, -1: none
    std::int32_t specular = -1;
    SpecGloss factors;
    Converted to;
  };
  std::int32_t wanted_place(int source, bool srgb);
  /// Makes the images of conversions, and drops those used only for them.
  void convert(const Workers& workers, std::vector<Image>& images);
  /// Returns encoded bytes, in the document or read into `owned`. Errors: kSceneUri, kSceneMissing,
  /// kSceneLimit.
  Result<std::span<const std::uint8_t>> bytes_of(int source,
                                                 std::vector<std::uint8_t>& owned) const;
  Result<void> judge(Wanted& wanted);
  /// Halves the largest images until all fit kMaxScenePixels. Error kSceneLimit: more to decode
  /// than the budget allows.
  Result<void> fit();
  /// Returns the end of the images from `begin` whose decoding fits into memory together.
  std::size_t batch_end(std::size_t begin) const;
  Result<void> leave_out(Wanted& wanted, const Error& error);

  const Document& document_;
  Tally& tally_;
  std::vector<Wanted> wanted_;
  std::vector<Conversion> conversions_;
  std::map<std::pair<int, bool>, std::int32_t> index_;
};

}  // namespace mirage::gltf
