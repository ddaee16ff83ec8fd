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

/// Adds up all views.
mirage_frame_info info_of(const mirage_client& client, FrameStep step) {
  const ClientSession& session = client.client.session();
  const auto count = [](std::size_t number) { return static_cast<std::uint32_t>(number); };
  mirage_frame_info out{};
  out.step = step == FrameStep::kDraw     ? MIRAGE_STEP_DRAW
             : step == FrameStep::kRefine ? MIRAGE_STEP_REFINE
                                          : MIRAGE_STEP_KEEP;
  out.at_rest = step == FrameStep::kKeep && session.at_rest() ? 1 : 0;
  out.samples = std::max(client.client.screen().samples(), 1);
  out.scale = client.client.planned().setting.scale;
  for (std::size_t view = 0; view < client.planned.size(); ++view) {
    const DrawList& list = client.client.planned(view).list;
    out.impostors += count(list.impostors.size());
    out.meshes += count(list.meshes.size());
    out.placeholders += count(list.placeholders.size());
    out.over_tau += count(list.over_tau);
    for (const DrawnImpostor& drawn : list.impostors) {
      out.bound_px = std::max(out.bound_px, drawn.bound_px);
    }
  }
  out.expected_flip = session.plan().expected_flip();
  return out;
}

/// Reads the views of a frame; each is as large as the first one says. nullopt: one of them is not
/// usable, and `problem` says why.
std::optional<std::vector<PlannedView>> read_views(const mirage_client& client,
                                                   const mirage_view* views, int32_t count,
                                                   std::string& problem) {
  if (!views || count < 1 || count > MIRAGE_MOST_VIEWS) {
    problem = "a frame has 1 to " + std::to_string(MIRAGE_MOST_VIEWS) + " views";
    return std::nullopt;
  }
  const SceneView& scene = client.client.session().scene();
  // The host's struct may be larger than the library's, if its header is newer.
  const std::size_t stride = views->size;
  if (stride < sizeof(mirage_view) || stride % alignof(mirage_view) != 0) {
    problem = "size of the view is not sizeof(mirage_view)";
    return std::nullopt;
  }
  std::vector<PlannedView> out;
  const auto* at = reinterpret_cast<const unsigned char*>(views);
  for (int32_t i = 0; i < count; ++i, at += stride) {
    const mirage_view& given = *reinterpret_cast<const mirage_view*>(at);
    std::optional<PlannedView> view;
    problem = "its size differs from that of the first one";
    if (given.size == stride) view = read_view(client, read_struct(given), problem);
    if (!view) {
      problem = "view " + std::to_string(i) + ": " + problem;
      return std::nullopt;
    }
    view->camera.fit_depth_range(scene.bounds_center, scene.bounds_radius);
    out.push_back(*view);
  }
  return out;
}

std::optional<HostTarget> read_target(const mirage_client& client, int32_t view,
                                      const mirage_target* target) {
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
  out.host = client.planned[static_cast<std::size_t>(view)].depth;
  return out;
}

mirage_result composite(mirage_client& client, std::size_t view, const HostTarget& target) {
  if (target.framebuffer != 0 && glIsFramebuffer(target.framebuffer) != GL_TRUE) {
    return bad_argument(client, "target.framebuffer is no framebuffer of this context");
  }
  glBindFramebuffer(GL_DRAW_FRAMEBUFFER, target.framebuffer);
  if (glCheckFramebufferStatus(GL_DRAW_FRAMEBUFFER) != GL_FRAMEBUFFER_COMPLETE) {
    return bad_argument(client, "target.framebuffer is not complete");
  }
  const Result<void> laid =
      client.composite->draw(client.client.screen(view).shown(), client.client.planned(view).camera,
                             client.placement.scale, client.options.no_sky == 0, target);
  return laid ? MIRAGE_OK : fail(client, laid.error());
}

}  // namespace

mirage_result mirage_plan(mirage_client* client, const mirage_view* views, int32_t count,
                          int64_t now_us, mirage_frame_info* info) {
  return on_gl_thread(client, [&]() -> mirage_result {
    if (!client->open) return wrong_state(*client, "mirage_update() comes first");
    if (now_us < client->now_us) return bad_argument(*client, "now_us went back");
    std::string problem;
    std::optional<std::vector<PlannedView>> read = read_views(*client, views, count, problem);
    if (!read) return bad_argument(*client, problem);
    client->now_us = now_us;
    client->planned.clear();
    if (!client->client.session().drawable()) return MIRAGE_NOT_YET;
    const GlGuard guard;
    std::vector<Camera> cameras;
    for (const PlannedView& view : *read) cameras.push_back(view.camera);
    const Result<FrameStep> step = client->client.plan(cameras, now_us);
    if (!step) return fail(*client, step.error());
    client->planned = std::move(*read);
    if (info) write_struct(*info, info_of(*client, *step));
    return MIRAGE_OK;
  });
}

mirage_result mirage_draw(mirage_client* client, int32_t view, const mirage_target* target) {
  return on_gl_thread(client, [&]() -> mirage_result {
    if (const auto no = not_planned(*client, view)) return *no;
    const std::optional<HostTarget> host = read_target(*client, view, target);
    if (!host) return bad_argument(*client, "the target is NULL, or a value in it is unknown");
    const GlGuard guard;
    client->client.draw(static_cast<std::size_t>(view));
    return composite(*client, static_cast<std::size_t>(view), *host);
  });
}

mirage_result mirage_composite(mirage_client* client, int32_t view, const mirage_target* target) {
  return on_gl_thread(client, [&]() -> mirage_result {
    if (const auto no = not_planned(*client, view)) return *no;
    const std::optional<HostTarget> host = read_target(*client, view, target);
    if (!host) return bad_argument(*client, "the target is NULL, or a value in it is unknown");
    const GlGuard guard;
    return composite(*client, static_cast<std::size_t>(view), *host);
  });
}

mirage_result mirage_draw_textures(mirage_client* client, int32_t view, mirage_textures* textures) {
  return on_gl_thread(client, [&]() -> mirage_result {
    if (const auto no = not_planned(*client, view)) return *no;
    if (!textures) return bad_argument(*client, "textures is NULL");
    const GlGuard guard;
    client->client.draw(static_cast<std::size_t>(view));
    const FrameTarget& picture = client->client.screen(static_cast<std::size_t>(view)).shown();
    const DepthMapping mapping =
        gl::has_clip_control() ? DepthMapping::kReversed : DepthMapping::kForward;
    const glm::dvec2 window =
        client->client.planned(static_cast<std::size_t>(view)).camera.window_depth(mapping) *
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
    if (client->planned.empty()) return wrong_state(*client, "mirage_plan() comes first");
    if (gpu_us < 0) return bad_argument(*client, "gpu_us is below 0");
    if (gpu_us > 0) client->client.done(static_cast<double>(gpu_us) * 1e-3, 0);
    return MIRAGE_OK;
  });
}
