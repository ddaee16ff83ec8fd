#pragma once
// KTX2 library: decodes textures of Basis Universal, which the module libmirage_ktx2.so does. A
// program that opens no such texture never loads it, and a build without it refuses them by name.

#include <cstdint>
#include <span>
#include <vector>

#include "protocol/base/result.h"

namespace mirage {

/// One mip level. Rows from the top, four bytes a pixel: red, green, blue, alpha (unassociated).
struct Ktx2Pixels {
  std::uint32_t width = 0, height = 0;
  std::vector<std::uint8_t> rgba;
};

class Ktx2Library {
 public:
  /// Decodes mip level `level` (0: the largest) of a file that holds one 2D picture as ETC1S or
  /// UASTC. Colours keep the encoding of the file, mostly sRGB. Besides the result it takes up to
  /// 1 GiB; a caller who wants less judges the header first (ktx2_header.h). Any thread. Errors:
  /// kSceneFormat (damaged, another kind of texture, no such level, a level of more than
  /// kMaxKtx2Pixels), kResources (no memory), kInternal (the transcoder does not start).
  virtual Result<Ktx2Pixels> decode(std::span<const std::uint8_t> bytes,
                                    std::uint32_t level) const = 0;

 protected:
  ~Ktx2Library() = default;
};

/// Name and type of the module's only function. Its number grows with each change of the classes
/// above, so that a module of another build is refused.
inline constexpr const char* kKtx2LibraryEntry = "mirage_ktx2_library_1";
using Ktx2LibraryEntry = const Ktx2Library* (*)();

/// Returns the library; the first call loads it. Error kModule. Any thread.
Result<const Ktx2Library*> ktx2_library();

}  // namespace mirage
