#include "modules/ktx2_library.h"

#include "modules/module.h"

namespace mirage {

Result<const Ktx2Library*> ktx2_library() {
  static const Result<const Ktx2Library*> library = []() -> Result<const Ktx2Library*> {
    const Result<void*> entry = load_module("mirage_ktx2", kKtx2LibraryEntry);
    if (!entry) return entry.error();
    return reinterpret_cast<Ktx2LibraryEntry>(*entry)();
  }();
  return library;
}

}  // namespace mirage
