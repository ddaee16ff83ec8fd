// Calls of mirage/frame.h.
#include <algorithm>
#include <cmath>

#include "client/draw/frame_renderer.h"
#include "client/draw/frame_target.h"
#include "client/frame/planned_frame.h"
#include "client/library/gl_guard.h"
#include "client/library/handle.h"
#include "client/plan/frame_plan.h"
#include "client/scene/scene_view.h"
#include "client/screen/screen.h"
#include "client/session/client_session.h"
#include "shaders/gl/dialect.h"

using namespace mirage;           // NOLINT: the border between C and the library
using namespace mirage::library;  // NOLINT

namespace {

mirage_frame_info info_of(const mirage_client& client, FrameStep step) {
  const PlannedFrame& frame = client.client.planned();
  const ClientSession& session = client.client.session();
  const auto count = [](std::size_t number) { return static_cast<std::uint32_t>(number); };
  mirage_frame_info out{};
  out.step = step == FrameStep::kDraw     ? MIRAGE_STEP_DRAW
             : step == FrameStep::kRefine ? MIRAGE_STEP_REFINE
                                          : MIRAGE_STEP_KEEP;
  out.at_rest = step == FrameStep::kKeep && session.at_rest() ? 1 : 0;
  out.samples = std::max(client.client.screen().samples(), 1);
  out.scale = frame.setting.scale;
  out.impostors = count(frame.list.impostors.size());
  out.meshes = count(frame.list.meshes.size());
  out.placeholders = count(frame.list.placeholders.size());
  out.over_tau = count(frame.list.over_tau);
  for (const DrawnImpostor& drawn : frame.list.impostors) {
    out.bound_px = std::max(out.bound_px, drawn.bound_px);
  }
  out.expected_flip = session.plan().expected_flip();
  return out;
}

std::optional<HostTarget> read_target(const mirage_client& client, const mirage_target* target) {
  if (!target || target->size < 2 * sizeof(uint32_t)) return std::nullopt;
  const mirage_target given = read_struct(*target);
  if (given.color < MIRAGE_COLOR_BY_SHADER || given.color > MIRAGE_COLOR_LINEAR)
    return std::nullopt;
  constexpr std::int32_t kFarthest = 1 << 20;
  if (std::abs(given.x) > kFarthest || std::abs(given.y) > kFarthest) return std::nullopt;
  HostTarget out;
  out.framebuffer = given.framebuffer;
  out.x = given.x;
  out.y = given.y;
  out.color = given.color == MIRAGE_COLOR_SRGB     ? HostColor::kEncodedByHardware
              : given.color == MIRAGE_COLOR_LINEAR ? HostColor::kLinear
                                                   : HostColor::kEncodedByShader;
  out.depth = given.no_depth == 0;
  out.host = client.planned->depth;
  return out;
}

mirage_result composite(mirage_client& client, const HostTarget& target) {
  if (target.framebuffer != 0 && glIsFramebuffer(target.framebuffer) != GL_TRUE) {
    return bad_argument(client, "target.framebuffer is no framebuffer of this context");
  }
  glBindFramebuffer(GL_DRAW_FRAMEBUFFER, target.framebuffer);
  if (glCheckFramebufferStatus(GL_DRAW_FRAMEBUFFER) != GL_FRAMEBUFFER_COMPLETE) {
    return bad_argument(client, "target.framebuffer is not complete");
  }
  const Result<void> laid =
      client.composite->draw(client.client.screen().shown(), client.client.planned().camera,
                             client.placement.scale, client.options.no_sky == 0, target);
  return laid ? MIRAGE_OK : fail(client, laid.error());
}

}  // namespace

mirage_result mirage_plan(mirage_client* client, const mirage_view* views, int32_t count,
                          int64_t now_us, mirage_frame_info* info) {
  return on_gl_thread(client, [&]() -> mirage_result {
    if (!client->open) return wrong_state(*client, "mirage_update() comes first");
    if (!views || count < 1 || views->size < sizeof(uint32_t)) {
      return bad_argument(*client, "there is no view");
    }
    if (count > 1) {
      return fail(*client, MIRAGE_UNSUPPORTED,
                  make_error(ErrorId::kUsage, "several views of a frame are not supported yet"));
    }
    if (now_us < client->now_us) return bad_argument(*client, "now_us went back");
    std::string problem;
    std::optional<PlannedView> view = read_view(*client, read_struct(*views), problem);
    if (!view) return bad_argument(*client, problem);
    client->now_us = now_us;
    client->planned.reset();
    ClientSession& session = client->client.session();
    if (!session.drawable()) return MIRAGE_NOT_YET;
    const GlGuard guard;
    Camera& camera = view->camera;
    const SceneView& scene = session.scene();
    camera.fit_depth_range(scene.bounds_center, scene.bounds_radius);
    const Result<void> sized =
        client->client.resize(static_cast<int>(camera.width), static_cast<int>(camera.height));
    if (!sized) return fail(*client, sized.error());
    const Result<FrameStep> step = client->client.plan(camera, now_us);
    if (!step) return fail(*client, step.error());
    client->planned = view;
    if (info) write_struct(*info, info_of(*client, *step));
    return MIRAGE_OK;
  });
}

mirage_result mirage_draw(mirage_client* client, int32_t view, const mirage_target* target) {
  return on_gl_thread(client, [&]() -> mirage_result {
    if (const auto no = not_planned(*client, view)) return *no;
    const std::optional<HostTarget> host = read_target(*client, target);
    if (!host) return bad_argument(*client, "the target is NULL, or a value in it is unknown");
    const GlGuard guard;
    client->client.draw();
    return composite(*client, *host);
  });
}

mirage_result mirage_composite(mirage_client* client, int32_t view, const mirage_target* target) {
  return on_gl_thread(client, [&]() -> mirage_result {
    if (const auto no = not_planned(*client, view)) return *no;
    const std::optional<HostTarget> host = read_target(*client, target);
    if (!host) return bad_argument(*client, "the target is NULL, or a value in it is unknown");
    const GlGuard guard;
    return composite(*client, *host);
  });
}

mirage_result mirage_draw_textures(mirage_client* client, int32_t view, mirage_textures* textures) {
  return on_gl_thread(client, [&]() -> mirage_result {
    if (const auto no = not_planned(*client, view)) return *no;
    if (!textures) return bad_argument(*client, "textures is NULL");
    const GlGuard guard;
    client->client.draw();
    const FrameTarget& picture = client->client.screen().shown();
    const DepthMapping mapping =
        gl::has_clip_control() ? DepthMapping::kReversed : DepthMapping::kForward;
    const glm::dvec2 window = client->client.planned().camera.window_depth(mapping) *
                              glm::dvec2(1, client->placement.scale);
    mirage_textures out{};
    out.color = picture.resolved_texture();
    out.depth = picture.depth_texture();
    out.width = picture.drawn_width();
    out.height = picture.drawn_height();
    out.window_x = window.x;
    out.window_y = window.y;
    if (out.depth == 0) {
      return fail(*client, make_error(ErrorId::kGraphicsGl, "no memory for a depth texture"));
    }
    write_struct(*textures, out);
    return MIRAGE_OK;
  });
}

mirage_result mirage_frame_done(mirage_client* client, int64_t gpu_us) {
  return on_gl_thread(client, [&]() -> mirage_result {
    if (!client->planned) return wrong_state(*client, "mirage_plan() comes first");
    if (gpu_us < 0) return bad_argument(*client, "gpu_us is below 0");
    if (gpu_us > 0) client->client.done(static_cast<double>(gpu_us) * 1e-3, 0);
    return MIRAGE_OK;
  });
}
