#include "protocol/wire/conversions.h"

#include <cmath>
#include <utility>

#include "protocol/base/limits.h"
#include "protocol/impostor/lighting_state.h"
#include "protocol/impostor/tile.h"
#include "protocol/model/scene_types.h"

namespace mirage {

wire::Vec3f to_wire(const glm::vec3& v) { return {v.x, v.y, v.z}; }
wire::Vec3d to_wire(const glm::dvec3& v) { return {v.x, v.y, v.z}; }
wire::Quat to_wire(const glm::quat& q) { return {q.w, q.x, q.y, q.z}; }
glm::vec3 from_wire(const wire::Vec3f& v) { return {v.x(), v.y(), v.z()}; }
glm::dvec3 from_wire(const wire::Vec3d& v) { return {v.x(), v.y(), v.z()}; }
glm::quat from_wire(const wire::Quat& q) { return {q.w(), q.x(), q.y(), q.z()}; }

std::unique_ptr<wire::LightingT> to_wire(const Lighting& lighting) {
  auto out = std::make_unique<wire::LightingT>();
  out->ambient = std::make_unique<wire::Vec3f>(to_wire(lighting.ambient));
  for (const Light& light : lighting.lights) {
    out->lights.emplace_back(to_wire(light.position), to_wire(light.color),
                             to_wire(light.direction), light.range, light.cos_inner,
                             light.cos_outer, static_cast<std::uint8_t>(light.kind));
  }
  const ProbeLight& p = lighting.probe;
  if (p.id != 0) {
    out->probe = std::make_unique<wire::ProbeLight>(to_wire(p.rotation), p.strength, p.id);
  }
  return out;
}

Result<Lighting> from_wire(const wire::LightingT& lighting) {
  Lighting out;
  out.ambient = lighting.ambient ? from_wire(*lighting.ambient) : glm::vec3(0);
  for (const wire::Light& l : lighting.lights) {
    if (l.kind() > static_cast<std::uint8_t>(LightKind::kSpot)) {
      return make_error(ErrorId::kWireValue, "unknown kind of light");
    }
    Light light;
    light.kind = static_cast<LightKind>(l.kind());
    light.position = from_wire(l.position());
    light.color = from_wire(l.color());
    light.direction = from_wire(l.direction());
    light.range = l.range();
    light.cos_inner = l.cos_inner();
    light.cos_outer = l.cos_outer();
    out.lights.push_back(light);
  }
  if (const wire::ProbeLight* p = lighting.probe.get()) {
    out.probe = {p->id(), from_wire(p->rotation()), p->strength()};
  }
  return checked_lighting(std::move(out));
}

void set_tile_fields(const Tile& tile, wire::TileReplyT& reply) {
  reply.edge = static_cast<std::uint16_t>(tile.edge);
  reply.crop_x = static_cast<std::uint16_t>(tile.crop.x);
  reply.crop_y = static_cast<std::uint16_t>(tile.crop.y);
  reply.crop_w = static_cast<std::uint16_t>(tile.crop.w);
  reply.crop_h = static_cast<std::uint16_t>(tile.crop.h);
  reply.plane_depth = tile.measure.plane_depth;
  reply.depth_min = tile.measure.depth_min;
  reply.depth_max = tile.measure.depth_max;
  reply.dz_quad = tile.measure.dz_quad;
  reply.dz_cuboid = tile.measure.dz_cuboid;
  reply.dz_hull = tile.measure.dz_hull;
  reply.depth_gap = tile.measure.depth_gap;
  reply.dz_behind = tile.measure.dz_behind;
  reply.lod_error = tile.measure.lod_error;
  reply.channels = tile.channels;
}

Result<Tile> tile_from_fields(const wire::TileReplyT& reply) {
  Tile tile;
  tile.edge = reply.edge;
  tile.crop = {reply.crop_x, reply.crop_y, reply.crop_w, reply.crop_h};
  tile.measure = {reply.plane_depth, reply.depth_min, reply.depth_max,
                  reply.dz_quad,     reply.dz_cuboid, reply.dz_hull,
                  reply.depth_gap,   reply.dz_behind, reply.lod_error};
  tile.channels = reply.channels;
  if (!valid_channels(tile.channels)) {
    return make_error(ErrorId::kWireValue, "tile has channels of no known kind");
  }
  const bool inside =
      tile.crop.x + tile.crop.w <= tile.edge && tile.crop.y + tile.crop.h <= tile.edge;
  if (tile.edge < 4 || tile.edge > limits::kMaxTileEdge || !inside) {
    return make_error(ErrorId::kWireValue, "tile crop leaves its window");
  }
  for (const float v :
       {reply.plane_depth, reply.depth_min, reply.depth_max, reply.dz_quad, reply.dz_cuboid,
        reply.dz_hull, reply.depth_gap, reply.dz_behind, reply.lod_error}) {
    if (!std::isfinite(v) || v < 0) {
      return make_error(ErrorId::kWireValue, "tile measure is negative or not finite");
    }
  }
  return tile;
}

}  // namespace mirage
