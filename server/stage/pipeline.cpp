#include "server/stage/pipeline.h"

namespace mirage {

Pipeline::Pipeline(const Clock& clock, std::size_t cache_bytes, CacheDirectory* directory,
                   std::function<void()> wake)
    : queues(clock, cache_bytes, directory),
      fetch_(queues, wake),
      render_(queues, wake),
      encode_(queues, wake),
      images_(queues, wake) {}

Result<std::string> Pipeline::start(std::shared_ptr<const PreparedScene> scene,
                                    const RenderOptions& options, int encoders) {
  fetch_.start();
  images_.start(scene);
  encode_.start(scene, encoders);
  return render_.start(std::move(scene), options);
}

void Pipeline::stop() {
  queues.completions.close();  // nobody takes them any more: nobody waits to hand one over
  queues.fetches.close();
  queues.tiles.close();
  render_.join();
  queues.rendered.close();
  encode_.join();
  queues.saves.close();
  fetch_.join();
  queues.images.close();
  images_.join();
}

}  // namespace mirage
