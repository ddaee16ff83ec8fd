#include "client/web/browser_link.h"

#include <emscripten.h>

// clang-format off
EM_JS(void, page_write, (const void* bytes, int size), {
  Module['write'](HEAPU8.slice(bytes, bytes + size));
});
// clang-format on

namespace mirage {
namespace {
// Header of a WebSocket packet, roughly: 2 to 14 bytes.
constexpr std::uint64_t kWebSocketOverhead = 8;
constexpr std::uint64_t kMask = 4;  // clients mask
}  // namespace

void BrowserLink::send(Bytes message) {
  if (!connected_) return;
  traffic_.bytes_up += message.size() + kWebSocketOverhead + kMask;
  write_(message);
}

void BrowserLink::set_connected(bool connected) {
  if (connected && !connected_) ++generation_;
  if (connected != connected_) inbound_.clear();
  connected_ = connected;
}

Result<void> BrowserLink::arrived(const Arrival& arrival) {
  Result<Message> message = decode_message(arrival.control, arrival.control_bytes);
  if (!message) return message.error();
  message->payload.assign(arrival.payload, arrival.payload + arrival.payload_bytes);
  message->payload_bytes = arrival.packed_bytes;
  message->wire_bytes = arrival.wire_bytes;
  message->waited_us = arrival.waited_us;
  message->unpacked = true;
  // Full renders are not counted, because they serve comparison, not the product.
  if (message->body.type != wire::Body::ReferenceReply) {
    traffic_.bytes_down += arrival.wire_bytes + kWebSocketOverhead;
  }
  inbound_.push_back(message.take());
  return {};
}

void write_to_socket(const Bytes& message) {
  page_write(message.data(), static_cast<int>(message.size()));
}

}  // namespace mirage
