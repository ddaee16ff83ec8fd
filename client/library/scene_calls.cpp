// Calls of mirage/client.h and mirage/stats.h about the scene, its light and place, and figures.
#include <algorithm>
#include <cmath>

#include "client/draw/frame_renderer.h"
#include "client/library/handle.h"
#include "client/scene/scene_view.h"
#include "client/screen/screen.h"
#include "client/session/client_session.h"
#include "protocol/impostor/lighting_state.h"

using namespace mirage;           // NOLINT: the border between C and the library
using namespace mirage::library;  // NOLINT

namespace {

constexpr int kMostLights = 16;
constexpr double kBrightest = 1e6;

bool bright(const double (&color)[3]) {
  return std::all_of(color, color + 3, [](double c) { return c >= 0 && c <= kBrightest; });
}

void put(double (&to)[3], const glm::dvec3& from) {
  for (int i = 0; i < 3; ++i) to[i] = from[i];
}

/// Reads a lighting. nullopt: a number in it is none, or out of range.
std::optional<Lighting> read_lighting(const mirage_lighting& given) {
  if (given.count < 0 || given.count > kMostLights || (given.count > 0 && !given.lights)) {
    return std::nullopt;
  }
  if (!bright(given.ambient)) return std::nullopt;
  Lighting out;
  out.ambient = glm::vec3(given.ambient[0], given.ambient[1], given.ambient[2]);
  for (int i = 0; i < given.count; ++i) {
    const mirage_light& light = given.lights[i];
    const glm::dvec3 way(light.direction[0], light.direction[1], light.direction[2]);
    if (!all_finite(light.direction, 3) || !(glm::length(way) > 0) || !bright(light.color)) {
      return std::nullopt;
    }
    Light one;
    one.color = glm::vec3(light.color[0], light.color[1], light.color[2]);
    one.direction = glm::vec3(glm::normalize(way));
    out.lights.push_back(one);
  }
  return out;
}

}  // namespace

mirage_result mirage_set_options(mirage_client* client, const mirage_options* options) {
  return at_border(client, [&]() -> mirage_result {
    if (!options || options->size < sizeof(uint32_t)) {
      return bad_argument(*client, "there are no options");
    }
    mirage_options given = read_struct(*options);
    if (!(given.frame_ms >= 0 && given.frame_ms <= 10'000)) {
      return bad_argument(*client, "frame_ms is 0 to 10,000");
    }
    given.size = sizeof(given);
    const bool sky_changed = (given.no_sky != 0) != (client->options.no_sky != 0);
    const bool pace_changed = given.frame_ms != client->options.frame_ms;
    client->options = given;
    if (pace_changed && client->open) {
      const double ms = given.frame_ms > 0 ? given.frame_ms : client->usual_frame_ms;
      client->client.session().set_frame_ms(ms);
    }
    if (sky_changed && client->composite) {
      client->client.renderer().show_background(given.no_sky == 0);
      client->client.screen().content_changed();
    }
    return MIRAGE_OK;
  });
}

mirage_result mirage_get_options(const mirage_client* client, mirage_options* options) {
  return at_border(client, [&]() -> mirage_result {
    if (!options) return bad_argument(*client, "options is NULL");
    write_struct(*options, client->options);
    return MIRAGE_OK;
  });
}

mirage_result mirage_set_lighting(mirage_client* client, const mirage_lighting* lighting) {
  return at_border(client, [&]() -> mirage_result {
    if (!lighting) {
      client->lighting.reset();
      return MIRAGE_OK;
    }
    if (lighting->size < sizeof(uint32_t)) return bad_argument(*client, "size is too small");
    std::optional<Lighting> read = read_lighting(read_struct(*lighting));
    if (!read)
      return bad_argument(*client, "a light is out of range, has no direction or no number");
    if (client->open && !(client->lighting && same_lighting(*client->lighting, *read))) {
      client->client.session().set_lighting(*read, client->now_us);
    }
    client->lighting = std::move(read);
    return MIRAGE_OK;
  });
}

mirage_result mirage_set_transform(mirage_client* client, const mirage_transform* transform) {
  return at_border(client, [&]() -> mirage_result {
    if (!transform || transform->size < sizeof(uint32_t)) {
      return bad_argument(*client, "there is no transform");
    }
    const mirage_transform given = read_struct(*transform);
    const std::optional<glm::dquat> rotation = read_rotation(given.rotation);
    if (!rotation) return bad_argument(*client, "rotation is no unit quaternion");
    if (!all_finite(given.translation, 3))
      return bad_argument(*client, "translation is not finite");
    const double scale = given.scale == 0 ? 1 : given.scale;
    if (!(scale >= 1e-20 && scale <= 1e20)) {
      return bad_argument(*client, "scale is 1e-20 to 1e20; mirroring cannot be said");
    }
    client->placement = {
        *rotation, {given.translation[0], given.translation[1], given.translation[2]}, scale};
    client->planned.clear();
    return MIRAGE_OK;
  });
}

mirage_result mirage_scene(const mirage_client* client, mirage_scene_info* info) {
  return at_border(client, [&]() -> mirage_result {
    if (!info) return bad_argument(*client, "info is NULL");
    if (!client->open || !client->client.session().drawable()) return MIRAGE_NOT_YET;
    const SceneView& scene = client->client.session().scene();
    const Placement& at = client->placement;
    client->scene_name = scene.name;
    mirage_scene_info out{};
    out.complete = scene.complete() ? 1 : 0;
    out.revision = scene.revision;
    out.name = client->scene_name.c_str();
    put(out.center, at.to_world(scene.bounds_center));
    out.radius = at.scale * scene.bounds_radius;
    Camera usual;
    usual.pose = home_pose(scene.home, usual);
    const glm::dvec3 ahead = usual.forward(), eye = usual.pose.eye;
    put(out.home_eye, at.to_world(eye));
    put(out.home_look, at.to_world(eye + ahead * glm::dot(scene.home.target - eye, ahead)));
    out.objects = scene.objects.size();
    out.instances = scene.all_instances;
    out.triangles = scene.triangles;
    write_struct(*info, out);
    return MIRAGE_OK;
  });
}

mirage_result mirage_get_stats(const mirage_client* client, mirage_stats* stats) {
  return at_border(client, [&]() -> mirage_result {
    if (!stats) return bad_argument(*client, "stats is NULL");
    if (!client->open) return MIRAGE_NOT_YET;
    const ClientSession& session = client->client.session();
    const TileCounts tiles = session.tiles();
    const LinkTraffic traffic = client->link.traffic();
    mirage_stats out{};
    out.connected = client->link.connected() ? 1 : 0;
    out.bytes_up = traffic.bytes_up;
    out.bytes_down = traffic.bytes_down;
    out.tiles_asked = tiles.asked;
    out.tiles_received = tiles.received;
    out.tiles_drawn = tiles.drawn;
    out.tiles_refused = tiles.refused;
    out.in_flight = session.in_flight();
    out.round_trip_us = session.round_trip_us();
    out.gpu_bytes = client->client.gpu_bytes();
    out.frames = session.frame_number();
    out.draw_calls = static_cast<std::uint32_t>(client->client.renderer().draw_calls());
    out.tau_px = session.tau_px();
    write_struct(*stats, out);
    return MIRAGE_OK;
  });
}
