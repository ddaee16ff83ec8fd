// Socket worker: the code of the worker that owns the socket. It takes WebSocket packets and
// returns whole, unpacked messages. socket_worker.js calls the exports; returned memory belongs to
// this side, and is valid until the next call.

#include <emscripten.h>

#include <array>
#include <optional>

#include "protocol/wire/unpack.h"

namespace mirage {
namespace {

struct Socket {
  PacketAssembler assembler{limits::kMaxTransferBytes};
  MessageUnpacker unpacker;
  std::uint32_t next_transfer = 1;
  std::size_t wire_bytes = 0;  // of the message under way
  Bytes control, payload;      // of the message accepted last
  std::vector<Bytes> packets;  // of the message split last
  std::string problem;
};

Socket& socket() {
  static Socket one;
  return one;
}

// Keeps the control part alone, as a message, and the payload.
Result<void> take(const Bytes& whole, Socket& s) {
  Result<Message> message = decode_message(whole.data(), whole.size());
  if (!message) return message.error();
  if (Result<void> done = s.unpacker.unpack(*message); !done) return done.error();
  const std::size_t control = whole.size() - message->payload_bytes;
  s.control.assign(whole.begin(), whole.begin() + static_cast<std::ptrdiff_t>(control));
  PacketHeader header;
  header.control_bytes = static_cast<std::uint32_t>(control - kWireHeaderBytes);
  write_packet_header(header, s.control.data());
  s.payload = std::move(message->payload);
  return {};
}

}  // namespace
}  // namespace mirage

using mirage::Bytes;
using mirage::socket;

extern "C" {

/// Restarts for a new connection.
EMSCRIPTEN_KEEPALIVE void socket_reset() { socket() = {}; }

/// Takes a packet. Returns seven words. The first: 1 if a message is there, 0 if it is not whole
/// yet, -1 if it was refused. Then address and size of its control part and of its payload, the
/// payload's bytes on the wire, and those of the whole message.
EMSCRIPTEN_KEEPALIVE const std::int32_t* socket_accept(const std::uint8_t* bytes,
                                                       std::size_t size) {
  static std::array<std::int32_t, 7> out;
  mirage::Socket& s = socket();
  out = {};
  s.wire_bytes += size;
  const auto refuse = [&](const mirage::Error& error) {
    s.problem = error.text;
    out[0] = -1;
    return out.data();
  };
  mirage::Result<std::optional<Bytes>> whole = s.assembler.accept(bytes, size);
  if (!whole) return refuse(whole.error());
  if (!whole->has_value()) return out.data();
  if (mirage::Result<void> taken = take(**whole, s); !taken) return refuse(taken.error());
  const std::size_t packed = (**whole).size() - s.control.size();
  out = {1,
         static_cast<std::int32_t>(reinterpret_cast<std::intptr_t>(s.control.data())),
         static_cast<std::int32_t>(s.control.size()),
         static_cast<std::int32_t>(reinterpret_cast<std::intptr_t>(s.payload.data())),
         static_cast<std::int32_t>(s.payload.size()),
         static_cast<std::int32_t>(packed),
         static_cast<std::int32_t>(std::exchange(s.wire_bytes, 0))};
  return out.data();
}

EMSCRIPTEN_KEEPALIVE const char* socket_problem() { return socket().problem.c_str(); }

/// Splits a message. Returns the number of WebSocket packets it is sent as.
EMSCRIPTEN_KEEPALIVE std::size_t socket_split(const std::uint8_t* bytes, std::size_t size) {
  mirage::Socket& s = socket();
  s.packets = mirage::split_into_packets(Bytes(bytes, bytes + size), s.next_transfer++);
  return s.packets.size();
}
EMSCRIPTEN_KEEPALIVE const std::uint8_t* socket_packet(std::size_t index) {
  return socket().packets[index].data();
}
EMSCRIPTEN_KEEPALIVE std::size_t socket_packet_bytes(std::size_t index) {
  return socket().packets[index].size();
}

}  // extern "C"
