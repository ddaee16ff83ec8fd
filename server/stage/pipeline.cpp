#include "server/stage/pipeline.h"

#include <utility>

#include "server/stage/encode_stage.h"
#include "server/stage/fetch_stage.h"
#include "server/stage/ground_stage.h"
#include "server/stage/image_stage.h"
#include "server/stage/machine_share.h"
#include "server/stage/render_options.h"
#include "server/stage/render_stage.h"
#include "server/stage/stand_in_stage.h"

namespace mirage {

struct Pipeline::Stages {
  Stages(StageQueues& queues, const std::function<void()>& wake)
      : fetch(queues, wake),
        render(queues, wake),
        stand_in(queues, wake),
        encode(queues, wake),
        images(queues, wake),
        grounds(queues, wake) {}
  FetchStage fetch;
  RenderStage render;
  StandInStage stand_in;  ///< only one of the two is started
  EncodeStage encode;
  ImageStage images;
  GroundStage grounds;
};

Pipeline::Pipeline(const Clock& clock, std::size_t cache_bytes, TileSources sources,
                   std::function<void()> wake)
    : queues(clock, cache_bytes, std::move(sources)),
      stages_(std::make_unique<Stages>(queues, wake)) {}

Pipeline::~Pipeline() { stop(); }

Result<std::string> Pipeline::start(std::shared_ptr<const PreparedScene> scene,
                                    const RenderOptions& options, int encoders) {
  stages_->fetch.start();
  stages_->images.start(scene);
  stages_->grounds.start(scene);
  Renderer renderer;
  if (options.stand_in_ms > 0) {
    renderer.name = stages_->stand_in.start(options);
  } else {
    Result<Renderer> started = stages_->render.start(scene, options);
    if (!started) return started.error();
    renderer = started.take();
  }
  encoders_ = encoders > 0 ? encoders : encoders_for(usable_cores(), renderer.software);
  stages_->encode.start(std::move(scene), encoders_);
  return renderer.name;
}

void Pipeline::stop() {
  queues.completions.close();  // nobody takes them any more, so no stage waits to hand one over
  queues.fetches.close();
  queues.tiles.close();
  stages_->render.join();
  stages_->stand_in.join();
  queues.close_drawn();
  stages_->encode.join();
  queues.saves.close();
  stages_->fetch.join();
  queues.images.close();
  stages_->images.join();
  queues.grounds.close();
  stages_->grounds.join();
}

}  // namespace mirage
