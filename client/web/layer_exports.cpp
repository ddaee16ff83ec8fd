// Layer exports: the functions that other people's pages call through packaging/npm/index.js. Texts
// are UTF-8. Returned memory belongs to this side, and is valid until the next call.

#include <emscripten.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <memory>
#include <optional>

#include "client/scene/scene_view.h"
#include "client/screen/pilot.h"
#include "client/session/client_session.h"
#include "client/web/layer.h"
#include "client/web/steered_eye.h"
#include "protocol/model/sun_place.h"

namespace mirage {
namespace {

// Numbers of a view: eye (3), rotation x y z w (4), tangents left right down up (4), width, height.
constexpr int kViewNumbers = 13;
constexpr int kMostViews = 4;
constexpr double kMostPixels = 8192;
constexpr double kFarthest = 1e30;  // m

/// A layer of one page, whose module has no other, and an eye for pages that have none.
struct LayerPage {
  std::unique_ptr<Layer> layer;
  SteeredEye eye;
  double fov_y = 1.0471975511965976;  // radians
  int width = 1, height = 1;          // of the steered view, px
  std::string text;                   // text returned last
  std::array<double, 12> numbers{};   // numbers returned last
};

LayerPage& page() {
  static LayerPage one;
  return one;
}

Layer& layer() { return *page().layer; }

int fail(const std::string& why) {
  page().text = why;
  return -1;
}

std::int64_t us(double ms) { return std::llround(ms * 1000); }

/// Reads a view; nullopt: it is no perspective view.
std::optional<Camera> read_view(const double* n) {
  for (int i = 0; i < kViewNumbers; ++i) {
    if (!(std::abs(n[i]) <= kFarthest)) return std::nullopt;
  }
  const glm::dquat rotation(n[6], n[3], n[4], n[5]);
  if (!(std::abs(glm::length(rotation) - 1) < 1e-3)) return std::nullopt;
  if (!(n[11] >= 1 && n[12] >= 1 && n[11] <= kMostPixels && n[12] <= kMostPixels)) {
    return std::nullopt;
  }
  Camera camera;
  camera.pose.eye = {n[0], n[1], n[2]};
  camera.pose.rotation = glm::quat(glm::normalize(rotation));
  camera.width = static_cast<std::uint32_t>(n[11]);
  camera.height = static_cast<std::uint32_t>(n[12]);
  if (!(n[7] < n[8] && n[9] < n[10])) return std::nullopt;
  if (!set_tangents(camera, {n[7], n[8], n[9], n[10]})) return std::nullopt;
  return camera;
}

/// The camera of the steered eye.
Camera steered() {
  const LayerPage& p = page();
  Camera camera;
  camera.pose = p.eye.pose();
  camera.fov_y = p.fov_y;
  camera.width = static_cast<std::uint32_t>(p.width);
  camera.height = static_cast<std::uint32_t>(p.height);
  const SceneView& scene = layer().session().scene();
  camera.fit_depth_range(scene.bounds_center, scene.bounds_radius);
  return camera;
}

int frame(double now_ms, std::vector<Camera> views) {
  const SceneView& scene = layer().session().scene();
  for (Camera& view : views) view.fit_depth_range(scene.bounds_center, scene.bounds_radius);
  const Result<Layer::Frame> drawn = layer().frame(us(now_ms), views);
  if (!drawn) return fail(drawn.error().text);
  return (drawn->drawn ? 1 : 0) | (drawn->resting ? 2 : 0) | (drawn->drawable ? 4 : 0);
}

}  // namespace
}  // namespace mirage

using mirage::layer;
using mirage::page;

extern "C" {

/// Makes the layer; it draws after layer_attach(). `frame_ms` 0: by renderer; `samples` 0: chosen
/// frame by frame.
EMSCRIPTEN_KEEPALIVE void layer_start(double frame_ms, double tau_px, int samples, int atlas_mb,
                                      int mesh_mb, int sky, const char* token, const char* clip,
                                      const char* variant) {
  page().layer = std::make_unique<mirage::Layer>(
      mirage::LayerOptions{frame_ms, tau_px, samples, atlas_mb, mesh_mb, sky != 0, token,
                           mirage::SceneChoice{clip, variant}},
      mirage::write_to_socket);
}
/// Makes everything on the graphics card, in the current context. Returns 0, or < 0 if it failed:
/// layer_text() says why.
EMSCRIPTEN_KEEPALIVE int layer_attach() {
  const mirage::Result<void> attached = layer().attach();
  return attached ? 0 : mirage::fail(attached.error().text);
}
EMSCRIPTEN_KEEPALIVE void layer_detach(int context_lost) {
  if (layer().attached()) layer().detach(context_lost != 0);
}
EMSCRIPTEN_KEEPALIVE const char* layer_text() { return page().text.c_str(); }

EMSCRIPTEN_KEEPALIVE void layer_connected(int connected) {
  layer().link().set_connected(connected != 0);
}
/// Takes a message from the worker. Returns 0, or < 0 if it is damaged.
EMSCRIPTEN_KEEPALIVE int layer_arrived(const std::uint8_t* control, std::size_t control_bytes,
                                       const std::uint8_t* payload, std::size_t payload_bytes,
                                       std::size_t packed_bytes, std::size_t wire_bytes,
                                       double waited_ms) {
  const mirage::Result<void> taken =
      layer().link().arrived({control, control_bytes, payload, payload_bytes, packed_bytes,
                              wire_bytes, mirage::us(waited_ms)});
  return taken ? 0 : mirage::fail(taken.error().text);
}

/// Draws the views of a frame into their textures: 13 numbers each, as kViewNumbers says. Returns
/// bits: 1 drawn, 2 resting, 4 some of the scene is there; < 0: layer_text() says what failed.
EMSCRIPTEN_KEEPALIVE int layer_frame(double now_ms, const double* views, int count) {
  std::vector<mirage::Camera> cameras;
  for (int i = 0; i < std::min(count, mirage::kMostViews); ++i) {
    const std::optional<mirage::Camera> camera =
        mirage::read_view(views + static_cast<std::ptrdiff_t>(i) * mirage::kViewNumbers);
    if (!camera) return mirage::fail("view " + std::to_string(i) + " is no perspective view");
    cameras.push_back(*camera);
  }
  return mirage::frame(now_ms, std::move(cameras));
}
/// Returns six numbers of a picture: the names of colour and depth, width, height, and the two of
/// LayerPicture::window_depth. nullptr: the view has none.
EMSCRIPTEN_KEEPALIVE const double* layer_picture(int view) {
  const auto& pictures = layer().pictures();
  if (view < 0 || view >= static_cast<int>(pictures.size())) return nullptr;
  const mirage::LayerPicture& picture = pictures[static_cast<std::size_t>(view)];
  page().numbers = {static_cast<double>(picture.color),
                    static_cast<double>(picture.depth),
                    static_cast<double>(picture.width),
                    static_cast<double>(picture.height),
                    picture.window_depth.x,
                    picture.window_depth.y};
  return page().numbers.data();
}

/// Moves the page's own eye by ten numbers in the order of Steering, and draws what it sees.
/// Returns as layer_frame().
EMSCRIPTEN_KEEPALIVE int layer_steered_frame(double now_ms, int width, int height,
                                             const double* steering) {
  mirage::LayerPage& p = page();
  p.width = width;
  p.height = height;
  mirage::ClientSession& session = layer().session();
  p.eye.prepare(session, mirage::steered(), mirage::us(now_ms));
  const double* s = steering;
  const mirage::Steering by{{s[0], s[1]}, {s[2], s[3]}, {s[4], s[5], s[6]}, {s[7], s[8]}, s[9]};
  if (session.scene().welcomed()) p.eye.steer(by, session, mirage::steered());
  return mirage::frame(now_ms, {mirage::steered()});
}
/// Shows that picture on the canvas, which has its size.
EMSCRIPTEN_KEEPALIVE void layer_present() { layer().present(); }
/// Makes what is seen at a place (0 to 1, right and down) the pivot. Returns 0 if nothing is there.
EMSCRIPTEN_KEEPALIVE int layer_aim(double x, double y) {
  return std::isfinite(x + y) && page().eye.aim(layer().session(), mirage::steered(), {x, y});
}
EMSCRIPTEN_KEEPALIVE void layer_home() {
  if (layer().session().scene().welcomed())
    page().eye.go_home(layer().session(), mirage::steered());
}
EMSCRIPTEN_KEEPALIVE void layer_set_orbits(int orbits) {
  page().eye.pilot().set_mode(orbits ? mirage::SteerMode::kOrbit : mirage::SteerMode::kWalk);
}
/// Sets the eye and a point that it looks at, m. Ignored unless both are finite and differ.
EMSCRIPTEN_KEEPALIVE void layer_look(double ex, double ey, double ez, double tx, double ty,
                                     double tz) {
  const glm::dvec3 eye(ex, ey, ez), target(tx, ty, tz);
  const double apart = glm::length(target - eye);
  if (!(std::isfinite(apart) && apart > 0)) return;
  page().eye.set_pose(layer().session(), mirage::look_at(eye, target));
  page().eye.pilot().aim(target);
}
/// Returns the eye, the unit vector that it looks along, and the pivot: nine numbers.
EMSCRIPTEN_KEEPALIVE const double* layer_eye() {
  const mirage::Pose& pose = page().eye.pose();
  const glm::dvec3 ahead = glm::dquat(pose.rotation) * glm::dvec3(0, 0, -1);
  const glm::dvec3 pivot = page().eye.pilot().pivot();
  page().numbers = {pose.eye.x, pose.eye.y, pose.eye.z, ahead.x, ahead.y,
                    ahead.z,    pivot.x,    pivot.y,    pivot.z};
  return page().numbers.data();
}
/// Sets the vertical field of view of the page's own eye, degrees. Ignored unless it is 1 to 170.
EMSCRIPTEN_KEEPALIVE void layer_fov(double degrees) {
  if (degrees >= 1 && degrees <= 170) page().fov_y = degrees * std::acos(-1.0) / 180;
}

/// Returns four numbers of what is seen at a place of a view (0 to 1, right and down): 1 and the
/// point, m; 0: nothing is there.
EMSCRIPTEN_KEEPALIVE const double* layer_point_at(int view, double x, double y) {
  std::optional<glm::dvec3> point;
  if (view >= 0 && std::isfinite(x + y)) {
    point = layer().point_at(static_cast<std::size_t>(view), {x, y});
  }
  page().numbers = {};
  if (point) page().numbers = {1, point->x, point->y, point->z};
  return page().numbers.data();
}
/// Returns ten numbers of the scene: centre and radius of its bounds, its home view's eye and
/// target, m. nullptr: none is known yet.
EMSCRIPTEN_KEEPALIVE const double* layer_scene() {
  const mirage::SceneView& scene = layer().session().scene();
  if (!scene.welcomed()) return nullptr;
  const glm::dvec3 &c = scene.bounds_center, &e = scene.home.eye, &t = scene.home.target;
  page().numbers = {c.x, c.y, c.z, scene.bounds_radius, e.x, e.y, e.z, t.x, t.y, t.z};
  return page().numbers.data();
}
EMSCRIPTEN_KEEPALIVE const char* layer_scene_name() {
  page().text = layer().session().scene().name;
  return page().text.c_str();
}
/// Returns 1 once everything that the server describes unasked is here.
EMSCRIPTEN_KEEPALIVE int layer_complete() { return layer().session().scene().complete() ? 1 : 0; }
EMSCRIPTEN_KEEPALIVE const char* layer_goodbye() {
  page().text = layer().session().goodbye();
  return page().text.c_str();
}
EMSCRIPTEN_KEEPALIVE const char* layer_problem() { return layer().problem().c_str(); }
EMSCRIPTEN_KEEPALIVE const char* layer_figures(double now_ms) {
  page().text = layer().figures(mirage::us(now_ms));
  return page().text.c_str();
}

EMSCRIPTEN_KEEPALIVE void layer_play(int playing, double now_ms) {
  layer().session().play(playing != 0, mirage::us(now_ms));
}
/// Sets the sun's direction, degrees; not finite: the scene's own light.
EMSCRIPTEN_KEEPALIVE void layer_sun(double azimuth, double elevation, double now_ms) {
  mirage::Lighting light = layer().session().scene().lighting;
  if (std::isfinite(azimuth + elevation)) mirage::put_sun({azimuth, elevation}, light);
  layer().session().set_lighting(light, mirage::us(now_ms));
}
EMSCRIPTEN_KEEPALIVE void layer_gpu_ms(double ms) {
  if (std::isfinite(ms) && ms > 0) layer().note_gpu_ms(ms);
}

}  // extern "C"
