#pragma once
// Stages: the server's stages without the network, and asks for them; benchmarks of tiles share
// them.

#include <cmath>
#include <optional>
#include <vector>

#include "protocol/base/clock.h"
#include "protocol/base/limits.h"
#include "server/prepare/prepared_scene.h"
#include "server/stage/pipeline.h"
#include "server/stage/render_options.h"
#include "server/tile/stage_queues.h"

namespace mirage::bench {

/// Returns tiles of `edge` texels of every object, from directions that no two calls share.
inline std::vector<TileJob> tiles_of(const PreparedScene& scene, std::size_t count,
                                     std::uint32_t edge, std::uint32_t& serial) {
  std::vector<TileJob> jobs;
  for (std::size_t i = 0; i < count; ++i) {
    const double turn = 2.399963 * ++serial, height = 0.1 + 0.8 * (serial % 97) / 97.0;
    const double ring = std::sqrt(1 - height * height);
    TileJob job;
    job.key.scene_revision = scene.revision;
    job.key.object = static_cast<std::uint32_t>(i % scene.scene.objects.size());
    job.key.cell = *view_cell_from_direction({ring * std::cos(turn), height, ring * std::sin(turn)},
                                             limits::kMaxViewLevel);
    job.key.distance = *distance_bucket_from_radii(6, 3);
    while (tile_edge(job.key.size_class) < edge) ++job.key.size_class;
    job.key.channels = kLitTile;
    const ObjectDescription& object = scene.objects[job.key.object];
    job.lighting = object_lighting(scene.scene.lighting, {}, object.center, object.radius);
    job.id = tile_id(job.key);
    jobs.push_back(job);
  }
  return jobs;
}

/// The shipped stages, without the network: asks in, encoded tiles out.
class Stages {
 public:
  Result<void> start(std::shared_ptr<const PreparedScene> scene) {
    const Result<std::string> renderer = pipeline_.start(std::move(scene), {}, 1);
    return renderer ? Result<void>{} : renderer.error();
  }
  /// Makes the tiles. Returns them in the order in which they are done.
  std::vector<StoredTilePtr> make(const std::vector<TileJob>& jobs) {
    std::vector<StoredTilePtr> out;
    std::uint32_t request = 0;
    for (const TileJob& job : jobs) {
      pipeline_.queues.tiles.submit(job.key, job.id, job.lighting, {1, ++request, 1.0f, 0});
    }
    for (std::size_t done = 0; done < jobs.size(); ++done) {
      const std::optional<Completion> tile = pipeline_.queues.completions.pop();
      if (!tile) break;
      const FinishedTile& finished = std::get<FinishedTile>(*tile);
      pipeline_.queues.tiles.finish(finished.id);
      out.push_back(finished.tile);
    }
    return out;
  }

 private:
  SteadyClock clock_;
  Pipeline pipeline_{clock_, 256u << 20, {}};
};

}  // namespace mirage::bench
