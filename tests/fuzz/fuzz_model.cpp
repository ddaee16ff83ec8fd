// Geometry bytes: decoded geometry must be safe to draw from.
#include <cstddef>
#include <cstdint>

#include "fuzz_targets.h"
#include "protocol/codec/model_codec.h"
#include "protocol/model/need_mask.h"

namespace mirage::fuzz {

void run_model(const std::uint8_t* data, std::size_t size) {
  constexpr std::size_t kImages = 4;
  const Result<ObjectModel> model = decode_model(data, size, kImages);
  if (!model) return;
  for (const std::uint32_t i : model->mesh.indices) {
    if (i >= model->mesh.vertices.size()) fail("an index is out of range");
  }
  (void)object_needs(model->mesh, model->materials);
  const Bytes again = encode_model(*model);
  if (!decode_model(again.data(), again.size(), kImages)) {
    fail("a decoded model does not decode again");
  }
}

}  // namespace mirage::fuzz

#ifdef MIRAGE_FUZZ_ENTRY
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  mirage::fuzz::run_model(data, size);
  return 0;
}
#endif
