#include "server/stage/image_stage.h"

#include <spdlog/spdlog.h>

#include <new>

#include "protocol/base/result.h"
#include "protocol/codec/image_codec.h"
#include "protocol/codec/mip_chain.h"
#include "protocol/impostor/tile.h"
#include "server/prepare/prepared_scene.h"
#include "server/tile/stage_queues.h"
#include "server/tile/tile_job.h"

namespace mirage {

Bytes ImageStage::encode(const PreparedScene& scene, const ImageLevel& level) {
  const ImageDescription& description = scene.images[level.image];
  try {
    const Image reduced =
        reduced_image(scene.scene.images[level.image], image_level_size(description, level.level),
                      description.alpha_cutoff);
    Result<Bytes> encoded = encode_image(reduced);
    if (encoded) return encoded.take();
  } catch (const std::bad_alloc&) {
    spdlog::warn("refused: there is no memory to encode an image");
  }
  return {};
}

void ImageStage::start(std::shared_ptr<const PreparedScene> scene) {
  worker_ = std::thread([this, scene] {
    while (const std::optional<ImageLevel> level = queues_.images.pop()) {
      queues_.completions.push(FinishedImage{*level, encode(*scene, *level)});
      wake_();
    }
  });
}

void ImageStage::join() {
  if (worker_.joinable()) worker_.join();
}

}  // namespace mirage
