#include "client/view/run_log.h"

#include <spdlog/fmt/fmt.h>
#include <spdlog/spdlog.h>

#include "client/door/client.h"
#include "client/draw/frame_renderer.h"
#include "client/draw/frame_target.h"
#include "client/frame/planned_frame.h"
#include "client/host/client_host.h"
#include "client/host/png.h"
#include "client/plan/frame_plan.h"
#include "client/scene/scene_view.h"
#include "client/screen/screen.h"
#include "client/session/client_session.h"
#include "client/view/options.h"
#include "client/view/results.h"
#include "shaders/gl/dialect.h"
#include "shaders/gl/program.h"
#include "shaders/gl/renderer.h"

namespace mirage {
namespace {
constexpr double kToldEveryS = 5;
}  // namespace

void RunLog::note_arrivals(const ClientHost& host) {
  const SceneView& scene = host.session().scene();
  if (programs_at_scene_ == 0 && scene.complete()) {
    programs_at_scene_ = gl::programs_compiled();
    spdlog::info("{}: {} objects, {} instances, {} triangles on the server", scene.name,
                 scene.objects.size(), scene.instances.size(), scene.triangles);
  }
  if (host.link_up() == link_was_up_) return;
  link_was_up_ = host.link_up();
  spdlog::warn(
      "{}", link_was_up_ ? "server is back" : "server is gone: showing what is here, reconnecting");
}

void RunLog::record(const ClientHost& host, const Client& client) {
  RecordedFrame frame;
  const FramePlan& plan = host.session().plan();
  const DrawList& list = client.planned().list;
  frame.budget_ms = static_cast<float>(plan.budget_ms());
  frame.scale = static_cast<float>(plan.setting().scale);
  frame.visible = static_cast<std::uint32_t>(list.visible);
  frame.placeholders = static_cast<std::uint32_t>(list.placeholders.size());
  recorder_.end(frame);
}

void RunLog::note_frame(ClientHost& host, const Client& client, bool drawn,
                        const FrameTimes& times) {
  const ClientSession& session = host.session();
  const DrawList& list = client.planned().list;
  const std::int64_t shown_us = host.now_us();
  const bool own_images = !list.impostors.empty() || !list.meshes.empty();
  if (own_images) stats_.first_image(shown_us);
  if (own_images || list.view) stats_.first_picture(shown_us);
  stats_.note_gpu(client.renderer().gpu_bytes(), client.screen().gpu_bytes());
  if (session.light_changed()) stats_.add_light_lag(list, session.scene());
  stats_.note_plan(session.plan());
  stats_.add_frame(list, client.renderer().draw_calls(), times.session_ms, times.planned_us);
  if (const auto use = host.link_use()) stats_.note_use(session.first_waits(), *use);
  stats_.note_traffic(host.traffic(), times.planned_us - start_us_);
  stats_.note_asked(session.tiles().asked, times.planned_us - start_us_);
  if (!drawn) return;
  stats_.note_drawn(times.real_ms);
  record(host, client);
}

void RunLog::tell_progress(std::int64_t done) {
  const double now_s = static_cast<double>(clock_.now_us()) * 1e-6;
  if (told_s_ == 0) told_s_ = now_s;
  if (now_s - told_s_ < kToldEveryS) return;
  told_s_ = now_s;
  if (options_.length.frames > 0) {
    spdlog::info("frame {} of {}", done, options_.length.frames);
  } else {
    spdlog::info("{} frames", done);
  }
}

Result<void> RunLog::write_picture(const Client& client, std::int64_t frame) const {
  if (options_.out_dir.empty()) return {};
  const Screen& screen = client.screen();
  return write_png(fmt::format("{}/frame_{:05}.png", options_.out_dir, frame), screen.width(),
                   screen.height(), screen.shown().read());
}

Result<void> RunLog::compare(ClientHost& host, const Client& client) {
  const std::int64_t paused_at = host.clock().now_us();
  const PlannedFrame& planned = client.planned();
  const std::vector<std::uint8_t> drawn = client.screen().shown().read();
  const Result<ReferenceFrame> reference =
      host.reference(planned.camera, static_cast<std::uint32_t>(options_.reference_supersample));
  if (!reference) return reference.error();
  const Result<void> compared = comparison_.add(
      {planned, drawn, *reference, host.session().frame_number(), options_.reference_supersample},
      stats_, options_.out_dir);
  if (compared) host.leave_out_since(paused_at);  // comparing is no part of the session
  return compared;
}

Result<void> RunLog::finish(const ClientHost& host, const Client& client) const {
  SessionStats::Final end = end_of(host);
  end.atlas_budget = static_cast<std::size_t>(options_.atlas_mb) << 20;
  end.geometry_budget = static_cast<std::size_t>(options_.mesh_mb) << 20;
  end.upload_budget = static_cast<std::size_t>(options_.upload_kb) << 10;
  end.method = options_.method_name;
  end.tau_px = options_.tau_px;
  end.samples = client.screen().samples();
  end.programs = gl::programs_compiled();
  end.programs_after_scene = end.programs - programs_at_scene_;
  end.programs_in_draws = programs_in_draws_;
  end.duration_us = host.now_us() - start_us_;
  end.renderer = gl::renderer_name();
  end.wall_s = static_cast<double>(clock_.now_us()) * 1e-6;
  std::fputs(stats_.table(end).c_str(), stdout);
  if (const GLenum error = glGetError(); error != GL_NO_ERROR) {
    return make_error(ErrorId::kGraphicsGl, "GL error " + std::to_string(error));
  }
  return write_results({options_.trace_file, options_.explain_file, options_.stats_file}, stats_,
                       end, host.session(), recorder_);
}

}  // namespace mirage
