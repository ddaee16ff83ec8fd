#include "client/report/frame_comparison.h"

#include <algorithm>
#include <cmath>

#include "client/door/client.h"
#include "client/draw/frame_renderer.h"
#include "client/draw/frame_target.h"
#include "client/frame/planned_frame.h"
#include "client/scene/scene_view.h"
#include "client/screen/screen.h"
#include "client/session/client_session.h"
#include "shaders/gl/gl.h"

namespace mirage {

double FrameComparison::add_geometric(const PlannedFrame& planned, const ReferenceFrame& truth) {
  const SceneView& scene = *planned.scene;
  const double s = spec_.truth_samples;
  const std::uint64_t pixels_before = out_.geometric.object_pixels;
  const std::uint64_t holes_before = out_.geometric.holes;
  if (scene.complete()) {
    add_geometric_error(truth, (std::floor(s / 2) + 0.5) / s, planned, out_.geometric);
  } else if (!planned.list.view) {  // nothing is known yet: everything is missing
    const auto& ids = truth.ids;
    const auto missing =
        ids.size() - static_cast<std::size_t>(std::count(ids.begin(), ids.end(), 0u));
    out_.geometric.object_pixels += missing;
    out_.geometric.holes += missing;
  }
  const std::uint64_t pixels = out_.geometric.object_pixels - pixels_before;
  const std::uint64_t holes = out_.geometric.holes - holes_before;
  return pixels > 0 ? static_cast<double>(holes) / static_cast<double>(pixels) : 0;
}

Result<void> FrameComparison::compare(Client& client, const Drawn& run) {
  const ClientSession& session = client.session();
  Screen& screen = client.screen();
  const PlannedFrame& planned = client.planned();
  const Camera& camera = planned.camera;
  ComparedFrame compared;
  compared.frame = run.frame;
  const auto draw = [&] {
    const double began = clock_ms_();
    screen.draw(client.renderer(), planned);
    glFinish();
    return run.planned_ms + clock_ms_() - began;
  };
  // The first use compiles, so it is left out of the times (numerics.md section 1).
  if (out_.frames.empty() && spec_.draws_each > 1) draw();
  compared.client_ms = INFINITY;
  for (int i = 0; i < spec_.draws_each; ++i) {
    const double ms = draw();
    compared.client_ms = std::min(compared.client_ms, ms);
    out_.client_ms.push_back(ms);
  }
  for (int i = 0; i < run.rested && !screen.refined(); ++i) {
    screen.refine(client.renderer(), planned);
  }
  std::vector<std::uint8_t> drawn = screen.shown().read();
  Result<ReferencePtr> truth = truth_.at(camera, spec_.truth_samples);
  if (!truth) return truth.error();
  const std::uint32_t w = camera.width, h = camera.height;
  const ImageView seen{w, h, drawn.data()}, due{w, h, (*truth)->rgba.data()};
  compared.image = measure_images(due, seen);
  if (before_ + 1 == run.frame) {
    compared.flicker =
        flicker({w, h, truth_before_->rgba.data()}, {w, h, drawn_before_.data()}, due, seen);
  }
  if (spec_.observe && session.scene().complete()) {
    spec_.observe(
        {session.scene(), planned.list, session.considered(), session.plan(), **truth, seen, due});
  }
  compared.hole_fraction = add_geometric(planned, **truth);
  if (std::binary_search(spec_.pictured.begin(), spec_.pictured.end(), run.frame)) {
    out_.pictures.push_back({spec_.width, spec_.height, drawn, (*truth)->rgba});
  }
  before_ = run.frame;
  drawn_before_ = std::move(drawn);
  truth_before_ = *truth;
  out_.frames.push_back(compared);
  return {};
}

}  // namespace mirage
