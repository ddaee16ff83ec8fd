#pragma once
// Messages: a verified control part (FlatBuffers object API) plus payload bytes.

#include "protocol/codec/tile_codec.h"
#include "protocol/impostor/tile.h"
#include "protocol/model/scene_types.h"
#include "protocol/wire/wire.h"
#include "wire_generated.h"

namespace mirage {

struct Message {
  wire::BodyUnion body;
  Bytes payload;
  std::size_t wire_bytes = 0;     ///< bytes of the whole message as encoded
  std::size_t payload_bytes = 0;  ///< bytes of the payload as it arrived
  bool unpacked = false;          ///< the payload is in the form that unpack() makes
  /// Set by a link: time the message waited before it was fetched, µs. Fetching happens once a
  /// frame, and frames may be farther apart than a round trip takes.
  std::int64_t waited_us = 0;
};

/// Returns header, control part and payload of a message.
Bytes encode_body(const wire::BodyUnion& body, const Bytes& payload);
/// Encodes a body, which is one of the tables of wire.fbs (object API, e.g. HelloT).
template <typename BodyT>
Bytes encode_message(BodyT&& body, const Bytes& payload = {}) {
  wire::BodyUnion value;
  value.Set(std::forward<BodyT>(body));
  return encode_body(value, payload);
}

/// Decodes a whole message from hostile bytes: the control part is verified, every count is held
/// against limits.h and every float must be finite before anything is copied out.
/// Errors: kWireMalformed, kWireVersion, kWireLimit, kWireValue.
Result<Message> decode_message(const std::uint8_t* bytes, std::size_t size);

// Convert between wire structs and the types of the programs.
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

/// Returns the most bytes of credit that a tile with so many bytes of planes takes. It adds the
/// control part, the headers, and the headers of chunks.
constexpr std::size_t tile_credit_bytes(std::size_t planes) { return planes + 224 + planes / 4096; }

}  // namespace mirage
