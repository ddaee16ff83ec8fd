// Draco bytes of a glTF file: decoded data have whole triangles over existing points.
#include <cstddef>
#include <cstdint>

#include "fuzz_targets.h"
#include "server/scene/gltf/draco_decode.h"
#include "server/scene/gltf/gltf_limits.h"

namespace mirage::fuzz {

void run_draco(const std::uint8_t* data, std::size_t size) {
  const gltf::DracoAttribute wanted[] = {{0, 5126, 3}, {1, 5121, 4}};
  const auto mesh = gltf::decode_draco({data, size}, wanted, gltf::limits_within(1024));
  if (!mesh) return;
  if (mesh->indices.size() % 3 != 0) fail("a triangle is cut");
  for (const std::uint32_t index : mesh->indices) {
    if (index >= mesh->points) fail("an index is out of range");
  }
  if (mesh->attributes.size() != 2 ||
      mesh->attributes[0].size() != std::size_t{mesh->points} * 12 ||
      mesh->attributes[1].size() != std::size_t{mesh->points} * 4) {
    fail("an attribute does not have the size of its points");
  }
}

}  // namespace mirage::fuzz

#ifdef MIRAGE_FUZZ_ENTRY
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  mirage::fuzz::run_draco(data, size);
  return 0;
}
#endif
