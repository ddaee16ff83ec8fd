#pragma once
// Messages: a verified control part (FlatBuffers object API) plus payload bytes.

#include <cstdint>
#include <utility>

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

/// Returns the most bytes of credit that a tile with so many bytes of planes takes. It adds the
/// control part, the headers, and the headers of chunks.
constexpr std::size_t tile_credit_bytes(std::size_t planes) { return planes + 224 + planes / 4096; }

}  // namespace mirage
