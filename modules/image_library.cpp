#include "modules/image_library.h"

#include "modules/module.h"

namespace mirage {

Result<const ImageLibrary*> image_library() {
  static const Result<const ImageLibrary*> library = []() -> Result<const ImageLibrary*> {
    const Result<void*> entry = load_module("mirage_images", kImageLibraryEntry);
    if (!entry) return entry.error();
    return reinterpret_cast<ImageLibraryEntry>(*entry)();
  }();
  return library;
}

}  // namespace mirage
