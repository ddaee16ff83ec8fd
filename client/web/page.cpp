// Page exports: the functions that the page calls (viewer.js). Texts are UTF-8. Returned memory
// belongs to this side, and is valid until the next call.

#include <emscripten.h>
#include <emscripten/html5.h>

#include <array>
#include <cmath>
#include <cstdlib>
#include <glm/gtc/color_space.hpp>
#include <memory>

#include "client/frame/reference_frame.h"
#include "client/price/cost_model.h"
#include "client/scene/scene_view.h"
#include "client/screen/pilot.h"
#include "client/session/client_session.h"
#include "client/web/web_viewer.h"

namespace mirage {
namespace {

struct Page {
  std::unique_ptr<WebViewer> viewer;
  EMSCRIPTEN_WEBGL_CONTEXT_HANDLE context = 0;
  std::string text;                // text returned last
  std::vector<std::uint8_t> rgba;  // pixels returned last
  std::vector<float> depths;       // depths returned last
};

Page& page() {
  static Page one;
  return one;
}

bool make_context(Page& p) {
  EmscriptenWebGLContextAttributes attributes;
  emscripten_webgl_init_context_attributes(&attributes);
  attributes.alpha = attributes.depth = attributes.stencil = attributes.antialias = 0;
  attributes.majorVersion = 2;
  attributes.powerPreference = EM_WEBGL_POWER_PREFERENCE_HIGH_PERFORMANCE;
  p.context = emscripten_webgl_create_context("#mirage", &attributes);
  return p.context > 0 &&
         emscripten_webgl_make_context_current(p.context) == EMSCRIPTEN_RESULT_SUCCESS;
}

std::int64_t us(double ms) { return std::llround(ms * 1000); }

const std::vector<std::string>& choices(int kind) {
  const SceneChoices& offered = page().viewer->session().scene().choices;
  return kind == 0 ? offered.clips : offered.variants;
}

int fail(const std::string& why) {
  page().text = why;
  return -1;
}

}  // namespace
}  // namespace mirage

using mirage::page;

extern "C" {

/// Starts the viewer. Returns 0, or < 0 if it failed: page_text() says why. Call it again after
/// page_stop(), with a new context.
EMSCRIPTEN_KEEPALIVE int page_start(int width, int height, double frame_ms, double display_ms,
                                    int atlas_mb, int mesh_mb, const char* token, const char* clip,
                                    const char* variant) {
  mirage::Page& p = page();
  p.viewer.reset();
  if (!mirage::make_context(p)) return mirage::fail("there is no WebGL 2");
  mirage::WebOptions options{width,    height,  frame_ms, display_ms,
                             atlas_mb, mesh_mb, token,    {clip, variant}};
  mirage::Result<std::unique_ptr<mirage::WebViewer>> made =
      mirage::WebViewer::create(options, mirage::write_to_socket);
  if (!made) return mirage::fail(made.error().text);
  p.viewer = made.take();
  return 0;
}

/// Releases everything on the graphics card; the canvas is lost.
EMSCRIPTEN_KEEPALIVE void page_stop() {
  mirage::Page& p = page();
  p.viewer.reset();
  if (p.context > 0) emscripten_webgl_destroy_context(p.context);
  p.context = 0;
}

EMSCRIPTEN_KEEPALIVE const char* page_text() { return page().text.c_str(); }

EMSCRIPTEN_KEEPALIVE void page_connected(int connected) {
  page().viewer->link().set_connected(connected != 0);
}

/// Takes a message from the worker. Returns 0, or < 0 if it is damaged.
EMSCRIPTEN_KEEPALIVE int page_arrived(const std::uint8_t* control, std::size_t control_bytes,
                                      const std::uint8_t* payload, std::size_t payload_bytes,
                                      std::size_t packed_bytes, std::size_t wire_bytes,
                                      double waited_ms) {
  const mirage::Result<void> taken =
      page().viewer->link().arrived({control, control_bytes, payload, payload_bytes, packed_bytes,
                                     wire_bytes, mirage::us(waited_ms)});
  return taken ? 0 : mirage::fail(taken.error().text);
}

/// Draws a frame. Returns bits: 1 drawn, 2 resting, 4 some of the scene is there; < 0: page_text()
/// says what failed.
EMSCRIPTEN_KEEPALIVE int page_frame(double now_ms, int width, int height) {
  const mirage::Result<mirage::WebViewer::Frame> frame =
      page().viewer->frame(mirage::us(now_ms), width, height);
  if (!frame) return mirage::fail(frame.error().text);
  return (frame->drawn ? 1 : 0) | (frame->resting ? 2 : 0) | (frame->drawable ? 4 : 0);
}

/// Moves the eye by what a person did: ten numbers in the order of Steering.
EMSCRIPTEN_KEEPALIVE void page_steer(double drag_x, double drag_y, double turn_x, double turn_y,
                                     double right, double up, double ahead, double pan_x,
                                     double pan_y, double zoom) {
  page().viewer->steer(
      {{drag_x, drag_y}, {turn_x, turn_y}, {right, up, ahead}, {pan_x, pan_y}, zoom});
}
/// Turns about what is at a place of the picture (0 to 1, right and down). Returns 1, or 0 if
/// nothing is there.
EMSCRIPTEN_KEEPALIVE int page_aim(double x, double y) {
  return std::isfinite(x + y) && page().viewer->aim({x, y}) ? 1 : 0;
}
/// Returns the name of the object that is seen at a place; empty: it has none.
EMSCRIPTEN_KEEPALIVE const char* page_name_at(double x, double y) {
  page().text = std::isfinite(x + y) ? page().viewer->name_at({x, y}) : "";
  return page().text.c_str();
}
/// Returns the server's number of the object seen at a place; -1: nothing is there, or several as
/// one.
EMSCRIPTEN_KEEPALIVE int page_object_at(double x, double y) {
  if (!std::isfinite(x + y)) return -1;
  const std::optional<std::uint32_t> object = page().viewer->object_at({x, y});
  return object ? static_cast<int>(*object) : -1;
}
/// Returns 1 where one orbits, 0 where one walks.
EMSCRIPTEN_KEEPALIVE int page_orbits() {
  return page().viewer->steer_mode() == mirage::SteerMode::kOrbit ? 1 : 0;
}
EMSCRIPTEN_KEEPALIVE void page_set_orbits(int orbits) {
  page().viewer->set_steer_mode(orbits ? mirage::SteerMode::kOrbit : mirage::SteerMode::kWalk);
}

/// Returns 1 where feet stay on the ground, 0 where one flies, -1 where there is no ground to walk
/// on.
EMSCRIPTEN_KEEPALIVE int page_grounded() {
  const mirage::WebViewer& viewer = *page().viewer;
  return viewer.has_ground() ? (viewer.flies() ? 0 : 1) : -1;
}
EMSCRIPTEN_KEEPALIVE void page_set_grounded(int grounded) {
  page().viewer->set_flies(grounded == 0);
}

/// Sets the eye and a point that it looks at, m. Ignored unless both are finite and differ.
EMSCRIPTEN_KEEPALIVE void page_look(double ex, double ey, double ez, double tx, double ty,
                                    double tz) {
  const glm::dvec3 eye(ex, ey, ez), target(tx, ty, tz);
  const double apart = glm::length(target - eye);
  if (std::isfinite(apart) && apart > 0) page().viewer->set_pose(mirage::look_at(eye, target));
}

/// Returns the eye and the direction it looks in: six numbers.
EMSCRIPTEN_KEEPALIVE const double* page_pose() {
  static std::array<double, 6> out;
  const mirage::Pose& pose = page().viewer->pose();
  const glm::dvec3 ahead = glm::dquat(pose.rotation) * glm::dvec3(0, 0, -1);
  out = {pose.eye.x, pose.eye.y, pose.eye.z, ahead.x, ahead.y, ahead.z};
  return out.data();
}

/// Returns how often a server has welcomed this page; what it offers may then be another.
EMSCRIPTEN_KEEPALIVE int page_welcomes() {
  return static_cast<int>(page().viewer->session().welcomes());
}
/// Returns the number of clips (kind 0) or variants (kind 1) that the scene offers.
EMSCRIPTEN_KEEPALIVE int page_choice_count(int kind) {
  return static_cast<int>(mirage::choices(kind).size());
}
EMSCRIPTEN_KEEPALIVE const char* page_choice(int kind, int index) {
  return mirage::choices(kind).at(static_cast<std::size_t>(index)).c_str();
}
/// Returns the clip or the variant that is shown; empty: as the file is.
EMSCRIPTEN_KEEPALIVE const char* page_shown_choice(int kind) {
  const mirage::SceneChoice& shown = page().viewer->session().scene().choices.shown;
  return (kind == 0 ? shown.clip : shown.variant).c_str();
}
/// Sets the clip and the variant that the next connection asks for.
EMSCRIPTEN_KEEPALIVE void page_choose(const char* clip, const char* variant) {
  page().viewer->choose({clip, variant});
}

EMSCRIPTEN_KEEPALIVE int page_home_known() { return page().viewer->home_known() ? 1 : 0; }
/// Returns the distance from the home eye to the point it looks at, m.
EMSCRIPTEN_KEEPALIVE double page_home_distance() {
  const mirage::HomeView& home = page().viewer->session().scene().home;
  return glm::length(home.target - home.eye);
}
/// Stops the animation, or lets it go on.
EMSCRIPTEN_KEEPALIVE void page_play(int playing, double now_ms) {
  page().viewer->play(playing != 0, mirage::us(now_ms));
}
EMSCRIPTEN_KEEPALIVE int page_animated() { return page().viewer->session().animated() ? 1 : 0; }

EMSCRIPTEN_KEEPALIVE void page_home() { page().viewer->go_home(); }

/// Sets the vertical field of view, degrees. Ignored unless it is 1 to 170.
EMSCRIPTEN_KEEPALIVE void page_fov(double degrees) {
  if (degrees >= 1 && degrees <= 170) page().viewer->set_fov(degrees * std::acos(-1.0) / 180);
}
/// Sets how much of the usual time a moving picture may take. Ignored unless it is 0.1 to 10.
EMSCRIPTEN_KEEPALIVE void page_pace(double share) {
  if (share >= 0.1 && share <= 10) page().viewer->set_pace(share);
}

/// Sets the colour behind everything: sRGB bytes as 0xRRGGBB; < 0: the scene's own.
EMSCRIPTEN_KEEPALIVE void page_background(int rgb) {
  std::optional<glm::vec3> color;
  if (rgb >= 0) {
    const glm::ivec3 bytes(rgb >> 16 & 255, rgb >> 8 & 255, rgb & 255);
    color = glm::convertSRGBToLinear(glm::vec3(bytes) / 255.0f);
  }
  page().viewer->set_background(color);
}

/// Sets the sun's direction, degrees; not finite: the scene's own light.
EMSCRIPTEN_KEEPALIVE void page_sun(double azimuth, double elevation, double now_ms) {
  std::optional<mirage::SunPlace> at;
  if (std::isfinite(azimuth + elevation)) at = mirage::SunPlace{azimuth, elevation};
  page().viewer->set_sun(at, mirage::us(now_ms));
}

/// Returns azimuth (`part` 0) or elevation (1) of the scene's own sun, degrees; NaN: it has none.
EMSCRIPTEN_KEEPALIVE double page_own_sun(int part) {
  const auto at = page().viewer->own_sun();
  return at ? (part == 0 ? at->azimuth : at->elevation) : std::nan("");
}

EMSCRIPTEN_KEEPALIVE double page_drawn_frames() {
  return static_cast<double>(page().viewer->frame_prices().drawn_frames());
}
EMSCRIPTEN_KEEPALIVE void page_gpu_ms(double frame, double ms) {
  page().viewer->frame_prices().note_gpu_ms(static_cast<std::uint64_t>(frame), ms);
}
EMSCRIPTEN_KEEPALIVE double page_decode_ms() { return page().viewer->decode_ms(); }
EMSCRIPTEN_KEEPALIVE double page_upload_ms() { return page().viewer->upload_ms(); }
EMSCRIPTEN_KEEPALIVE void page_interval_ms(double ms) {
  page().viewer->frame_prices().note_interval_ms(ms);
}

/// Returns the number of prices: one for each kind of work.
EMSCRIPTEN_KEEPALIVE int page_price_count() { return static_cast<int>(mirage::kWorks); }
EMSCRIPTEN_KEEPALIVE const double* page_prices() { return page().viewer->prices().ms.data(); }
EMSCRIPTEN_KEEPALIVE void page_set_prices(const double* ms) {
  mirage::CostModel prices;
  for (std::size_t i = 0; i < mirage::kWorks; ++i) {
    if (!std::isfinite(ms[i]) || ms[i] < 0) return;
    prices.ms[i] = ms[i];
  }
  page().viewer->set_prices(prices);
}

EMSCRIPTEN_KEEPALIVE void page_probe() { page().viewer->probe(); }

EMSCRIPTEN_KEEPALIVE const char* page_figures(double now_ms) {
  page().text = page().viewer->figures(mirage::us(now_ms));
  return page().text.c_str();
}
EMSCRIPTEN_KEEPALIVE const char* page_renderer() {
  page().text = page().viewer->renderer();
  return page().text.c_str();
}
EMSCRIPTEN_KEEPALIVE const char* page_goodbye() {
  page().text = page().viewer->session().goodbye();
  return page().text.c_str();
}
EMSCRIPTEN_KEEPALIVE const char* page_scene_name() {
  page().text = page().viewer->session().scene().name;
  return page().text.c_str();
}

/// Shows an InsightLayer; another number shows the picture alone.
EMSCRIPTEN_KEEPALIVE void page_layer(int layer) {
  const bool known = layer > 0 && layer <= static_cast<int>(mirage::kInsightLayers);
  page().viewer->show_layer(known ? static_cast<mirage::InsightLayer>(layer)
                                  : mirage::InsightLayer::kNone);
}

EMSCRIPTEN_KEEPALIVE int page_width() { return page().viewer->width(); }
EMSCRIPTEN_KEEPALIVE int page_height() { return page().viewer->height(); }
/// Returns the RGBA pixels of page_width() x page_height(), rows from the top.
EMSCRIPTEN_KEEPALIVE const std::uint8_t* page_pixels() {
  page().rgba = page().viewer->pixels();
  return page().rgba.data();
}

/// Returns the eye depths of those pixels, m; 0: nothing is there. Null: page_text() says why.
EMSCRIPTEN_KEEPALIVE const float* page_depths() {
  mirage::Result<std::vector<float>> depths = page().viewer->depths();
  if (!depths) {
    page().text = depths.error().text;
    return nullptr;
  }
  page().depths = depths.take();
  return page().depths.data();
}
EMSCRIPTEN_KEEPALIVE void page_ask_reference(int supersample) {
  page().viewer->ask_reference(static_cast<std::uint32_t>(supersample));
}
/// Returns 1 if the full render is there (page_reference_pixels()), 0 if not yet, < 0 if the server
/// renders none.
EMSCRIPTEN_KEEPALIVE int page_reference() {
  mirage::Page& p = page();
  if (std::optional<mirage::ReferenceFrame> frame = p.viewer->session().take_reference()) {
    p.rgba = std::move(frame->rgba);
    return 1;
  }
  return p.viewer->session().reference_refused() ? -1 : 0;
}
EMSCRIPTEN_KEEPALIVE const std::uint8_t* page_reference_pixels() { return page().rgba.data(); }

}  // extern "C"
