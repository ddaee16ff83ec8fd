#include "server/stage/pipeline.h"

#include <utility>

#include "server/stage/encode_stage.h"
#include "server/stage/fetch_stage.h"
#include "server/stage/image_stage.h"
#include "server/stage/render_stage.h"

namespace mirage {

struct Pipeline::Stages {
  Stages(StageQueues& queues, const std::function<void()>& wake)
      : fetch(queues, wake), render(queues, wake), encode(queues, wake), images(queues, wake) {}
  FetchStage fetch;
  RenderStage render;
  EncodeStage encode;
  ImageStage images;
};

Pipeline::Pipeline(const Clock& clock, std::size_t cache_bytes, CacheDirectory* directory,
                   std::function<void()> wake)
    : queues(clock, cache_bytes, directory), stages_(std::make_unique<Stages>(queues, wake)) {}

Pipeline::~Pipeline() { stop(); }

Result<std::string> Pipeline::start(std::shared_ptr<const PreparedScene> scene,
                                    const RenderOptions& options, int encoders) {
  stages_->fetch.start();
  stages_->images.start(scene);
  stages_->encode.start(scene, encoders);
  return stages_->render.start(std::move(scene), options);
}

void Pipeline::stop() {
  queues.completions.close();  // nobody takes them any more: nobody waits to hand one over
  queues.fetches.close();
  queues.tiles.close();
  stages_->render.join();
  queues.rendered.close();
  stages_->encode.join();
  queues.saves.close();
  stages_->fetch.join();
  queues.images.close();
  stages_->images.join();
}

}  // namespace mirage
