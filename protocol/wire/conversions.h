#pragma once
// Conversions between wire structs and the types of the programs.

#include <glm/glm.hpp>
#include <glm/gtc/quaternion.hpp>
#include <memory>

#include "protocol/base/result.h"
#include "wire_generated.h"

namespace mirage {

struct Lighting;
struct Tile;

wire::Vec3f to_wire(const glm::vec3& v);
wire::Vec3d to_wire(const glm::dvec3& v);
wire::Quat to_wire(const glm::quat& q);
glm::vec3 from_wire(const wire::Vec3f& v);
glm::dvec3 from_wire(const wire::Vec3d& v);
glm::quat from_wire(const wire::Quat& q);
std::unique_ptr<wire::LightingT> to_wire(const Lighting& lighting);
/// Converts and checks by checked_lighting(). Error kWireValue.
Result<Lighting> from_wire(const wire::LightingT& lighting);

/// Writes the fields of a tile, without its planes, into a reply.
void set_tile_fields(const Tile& tile, wire::TileReplyT& reply);
/// Reads them back. Error kWireValue: the crop leaves the window, or a measure is not finite.
Result<Tile> tile_from_fields(const wire::TileReplyT& reply);

}  // namespace mirage
