#include "server/tile/reference_encode.h"

#include "protocol/codec/tile_codec.h"
#include "protocol/wire/message.h"

namespace mirage {
namespace {

/// Moves a plane to the end. A frame may have hundreds of megabytes, and two copies would be too
/// much.
template <typename T>
void append(Bytes& out, std::vector<T>& plane) {
  const auto* bytes = reinterpret_cast<const std::uint8_t*>(plane.data());
  out.insert(out.end(), bytes, bytes + plane.size() * sizeof(T));
  std::vector<T>().swap(plane);
}

}  // namespace

FinishedReference refused_reference(SessionId session, std::uint32_t request_id) {
  wire::RefusedT refused;
  refused.request_id = request_id;
  refused.reason = wire::RefusalReason::TooLarge;
  return {session, encode_message(std::move(refused))};
}

Bytes encode_reference(RenderedReference&& drawn) {
  wire::ReferenceReplyT reply;
  reply.request_id = drawn.request_id;
  reply.width = drawn.width;
  reply.height = drawn.height;
  reply.render_us = drawn.render_us;
  Bytes raw;
  raw.reserve(drawn.frame.rgba.size() + 4 * (drawn.frame.depth.size() + drawn.frame.ids.size()));
  append(raw, drawn.frame.rgba);
  append(raw, drawn.frame.depth);
  append(raw, drawn.frame.ids);
  reply.raw_bytes = static_cast<std::uint32_t>(raw.size());
  return encode_message(std::move(reply), compress_block(raw.data(), raw.size()));
}

}  // namespace mirage
