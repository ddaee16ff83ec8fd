// Image bytes: a decoded image has the size that was asked for.
#include <cstddef>
#include <cstdint>

#include "fuzz_targets.h"
#include "protocol/codec/image_codec.h"

namespace mirage::fuzz {

void run_image(const std::uint8_t* data, std::size_t size) {
  const Result<Image> image = decode_image(data, size, {8, 4}, true);
  if (image && image->rgba.size() != 8 * 4 * 4) fail("an image has another size than asked for");
}

}  // namespace mirage::fuzz

#ifdef MIRAGE_FUZZ_ENTRY
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  mirage::fuzz::run_image(data, size);
  return 0;
}
#endif
