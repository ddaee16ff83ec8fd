// What the worker runs that owns the socket: WebSocket messages in, whole messages out, unpacked;
// and FLIP, which takes long. Its exports are called by socket_worker.js; memory they return is
// theirs until the next call.

#include <emscripten.h>

#include <array>
#include <optional>

#include "client/quality/flip.h"
#include "protocol/wire/unpack.h"

namespace mirage {
namespace {

struct Socket {
  FrameAssembler assembler{limits::kMaxTransferBytes};
  std::uint32_t next_transfer = 1;
  std::size_t wire_bytes = 0;  // of the message under way
  Bytes control, payload;      // of the message accepted last
  std::vector<Bytes> frames;   // of the message split last
  std::string problem;
};

Socket& socket() {
  static Socket one;
  return one;
}

// The control part alone, as a message.
Result<void> take(const Bytes& whole, Socket& s) {
  Result<Message> message = decode_message(whole.data(), whole.size());
  if (!message) return message.error();
  if (Result<void> done = unpack(*message); !done) return done.error();
  const std::size_t control = whole.size() - message->payload_bytes;
  s.control.assign(whole.begin(), whole.begin() + static_cast<std::ptrdiff_t>(control));
  FrameHeader header;
  header.control_bytes = static_cast<std::uint32_t>(control - kWireHeaderBytes);
  write_frame_header(header, s.control.data());
  s.payload = std::move(message->payload);
  return {};
}

}  // namespace
}  // namespace mirage

using mirage::Bytes;
using mirage::socket;

extern "C" {

/// A new connection.
EMSCRIPTEN_KEEPALIVE void socket_reset() { socket() = {}; }

/// What came. Seven words: 1: a message is there, 0: not whole yet, -1: refused; where its control
/// part and its payload are, with their sizes; the payload's as it came, and the whole message's.
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

/// How many WebSocket messages a message is sent as.
EMSCRIPTEN_KEEPALIVE std::size_t socket_split(const std::uint8_t* bytes, std::size_t size) {
  mirage::Socket& s = socket();
  s.frames = mirage::split_into_frames(Bytes(bytes, bytes + size), s.next_transfer++);
  return s.frames.size();
}
EMSCRIPTEN_KEEPALIVE const std::uint8_t* socket_frame(std::size_t index) {
  return socket().frames[index].data();
}
EMSCRIPTEN_KEEPALIVE std::size_t socket_frame_bytes(std::size_t index) {
  return socket().frames[index].size();
}

/// Mean FLIP of two RGBA pictures; < 0: they cannot be compared.
EMSCRIPTEN_KEEPALIVE double picture_flip(const std::uint8_t* reference, const std::uint8_t* test,
                                         std::uint32_t width, std::uint32_t height) {
  const std::optional<mirage::FlipMap> map =
      mirage::flip_map({width, height, reference}, {width, height, test});
  return map ? mirage::flip_mean(*map).value_or(-1) : -1;
}

}  // extern "C"
