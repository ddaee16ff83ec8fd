// Everything that a peer's bytes go through before a program acts on them: packets, messages,
// fields.
#include <algorithm>
#include <cstddef>
#include <cstdint>

#include "fuzz_targets.h"
#include "protocol/codec/ground_codec.h"
#include "protocol/codec/tile_codec.h"
#include "protocol/impostor/light_probe.h"
#include "protocol/impostor/view_tile.h"
#include "protocol/model/scene_types.h"
#include "protocol/wire/conversions.h"
#include "protocol/wire/light_probe_codec.h"
#include "protocol/wire/message.h"
#include "protocol/wire/unpack.h"
#include "protocol/wire/view_codec.h"

namespace mirage::fuzz {
namespace {

// True if a tile or a view is accepted in the form it came in.
bool decodes(const wire::BodyUnion& body, const Bytes& payload) {
  if (const auto* view = body.AsViewReply()) return static_cast<bool>(decode_view(*view, payload));
  const wire::TileReplyT& reply = *body.AsTileReply();
  Result<Tile> tile = tile_from_fields(reply);
  return tile && decode_tile_planes(payload.data(), payload.size(),
                                    static_cast<TileCodec>(reply.codec), *tile);
}

// A payload that a link unpacks ahead is accepted exactly if the packed one is.
void unpack_ahead(Message message) {
  const wire::BodyUnion& body = message.body;
  const auto* view = body.AsViewReply();
  const bool compared = view || body.AsTileReply();
  const bool whole = compared && decodes(body, message.payload);
  bool taken = static_cast<bool>(MessageUnpacker().unpack(message));
  if (body.AsTileReply() && taken) taken = static_cast<bool>(read_unpacked_tile(message));
  if (view && taken) taken = static_cast<bool>(view_of_planes(*view, message.payload));
  if (compared && taken != whole) fail("unpacked, a message is taken otherwise than packed");
}

void use_message(const std::uint8_t* bytes, std::size_t size) {
  Result<Message> message = decode_message(bytes, size);
  if (!message) return;
  const wire::BodyUnion& body = message->body;
  if (const auto* m = body.AsWelcome()) (void)from_wire(*m->lighting);
  if (const auto* m = body.AsSetLighting()) (void)from_wire(*m->lighting);
  if (const auto* m = body.AsLightProbePage()) (void)decode_probe(*m, message->payload);
  if (const auto* m = body.AsViewReply()) (void)decode_view(*m, message->payload);
  if (const auto* m = body.AsGroundReply()) (void)decode_ground(message->payload, m->raw_bytes);
  if (const auto* m = body.AsTileReply()) {
    Result<Tile> tile = tile_from_fields(*m);
    if (tile) {
      (void)decode_tile_planes(message->payload.data(), message->payload.size(),
                               static_cast<TileCodec>(m->codec), *tile);
    }
  }
  // A message that was accepted can be sent again, and is accepted again.
  const Bytes again = encode_body(body, message->payload);
  if (!decode_message(again.data(), again.size())) fail("a decoded message does not decode again");
  unpack_ahead(message.take());
}

}  // namespace

/// The input is a stream of WebSocket packets. The header of each one gives its length; the rest at
/// the end is passed on as it is.
void run_message(const std::uint8_t* data, std::size_t size) {
  use_message(data, size);
  PacketAssembler assembler(limits::kMaxInboundTransferBytes);
  while (size > 0) {
    std::size_t n = size;
    if (size >= kWireHeaderBytes) {
      std::uint64_t whole = kWireHeaderBytes;
      for (std::size_t i = 0; i < 8; ++i) {
        whole += static_cast<std::uint64_t>(data[4 + i]) << (8 * (i % 4));
      }
      n = static_cast<std::size_t>(std::min<std::uint64_t>(whole, size));
    }
    const Result<std::optional<Bytes>> frame = assembler.accept(data, n);
    if (!frame) return;
    if (*frame) use_message((*frame)->data(), (*frame)->size());
    data += n;
    size -= n;
  }
}

}  // namespace mirage::fuzz

#ifdef MIRAGE_FUZZ_ENTRY
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  mirage::fuzz::run_message(data, size);
  return 0;
}
#endif
