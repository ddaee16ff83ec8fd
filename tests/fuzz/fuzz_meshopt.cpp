// Compressed bufferViews of a glTF file: decoded data have the declared size.
#include <cstddef>
#include <cstdint>

#include "fuzz_targets.h"
#include "server/scene/gltf/meshopt_decode.h"

namespace mirage::fuzz {

/// u8 mode, u8 filter, u16 stride, u32 count (little-endian), then the bitstream.
void run_meshopt(const std::uint8_t* data, std::size_t size) {
  constexpr std::size_t kFieldBytes = 8;
  constexpr const char* kModes[] = {"ATTRIBUTES", "TRIANGLES", "INDICES", "OTHERS"};
  constexpr const char* kFilters[] = {"", "OCTAHEDRAL", "QUATERNION", "EXPONENTIAL"};
  if (size < kFieldBytes) return;
  const std::uint32_t stride = data[2] | data[3] << 8;
  const std::uint32_t count =
      data[4] | data[5] << 8 | data[6] << 16 | static_cast<std::uint32_t>(data[7]) << 24;
  const auto view = gltf::meshopt_view(kModes[data[0] % 4], kFilters[data[1] % 4], count, stride);
  if (!view) return;
  const auto bytes = gltf::decode_meshopt({data + kFieldBytes, size - kFieldBytes}, *view);
  if (bytes && bytes->size() != view->decoded_bytes())
    fail("a view has another size than declared");
}

}  // namespace mirage::fuzz

#ifdef MIRAGE_FUZZ_ENTRY
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  mirage::fuzz::run_meshopt(data, size);
  return 0;
}
#endif
