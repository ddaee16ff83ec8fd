#include "server/stage/ground_stage.h"

#include <spdlog/spdlog.h>

#include <new>

#include "protocol/codec/ground_codec.h"
#include "server/ground/ground.h"
#include "server/prepare/prepared_scene.h"
#include "server/tile/stage_queues.h"

namespace mirage {
namespace {

EncodedGround encoded_ground(const PreparedScene& scene, GroundBlockId id) {
  try {
    const Result<GroundBlock> made = make_ground(scene, {scene.scene.home.walk_eye_m}, id);
    if (made) return {encode_ground(*made), static_cast<std::uint32_t>(ground_bytes(*made))};
    spdlog::warn("{}", made.error().line());
  } catch (const std::bad_alloc&) {
    spdlog::warn("refused: there is no memory for a block of ground");
  }
  return {};
}

}  // namespace

void GroundStage::start(std::shared_ptr<const PreparedScene> scene) {
  worker_ = std::thread([this, scene] {
    while (const std::optional<GroundBlockId> id = queues_.grounds.pop()) {
      queues_.completions.push(FinishedGround{*id, encoded_ground(*scene, *id)});
      wake_();
    }
  });
}

void GroundStage::join() {
  if (worker_.joinable()) worker_.join();
}

}  // namespace mirage
