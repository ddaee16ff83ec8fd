// Socket worker: the code of the worker that owns the socket. It takes WebSocket packets and
// returns whole, unpacked messages; it also computes FLIP, which takes long. socket_worker.js calls
// the exports; returned memory belongs to this side, and is valid until the next call.

#include <emscripten.h>

#include <array>
#include <optional>

#include "client/quality/flip.h"
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

constexpr std::uint32_t kWorstOfHeight = 16;  // edges of the worst square in a picture's height

/// The last measurement of picture_flip().
struct Compared {
  std::array<double, 6> flip{-1, -1, -1, -1, -1, -1};
  std::vector<std::uint8_t> heat;  // RGBA
};

Compared& compared() {
  static Compared one;
  return one;
}

// Returns the pixels that objects cover by half or more.
Mask covered(const ImageView& picture) {
  Mask out{picture.width, picture.height, std::vector<std::uint8_t>(picture.pixels())};
  for (std::size_t i = 0; i < picture.pixels(); ++i) out.inside[i] = picture.rgba[4 * i + 3] >= 128;
  return out;
}

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

/// Measures two RGBA pictures; the reference's alpha is its coverage by objects. Returns three FLIP
/// values: the mean of the picture, the mean where objects are, and what 99 % of the pixels there
/// stay within; then the place of the worst square (shares of width and height, right and down),
/// and its mean. < 0: there is none.
EMSCRIPTEN_KEEPALIVE const double* picture_flip(const std::uint8_t* reference,
                                                const std::uint8_t* test, std::uint32_t width,
                                                std::uint32_t height) {
  mirage::Compared& out = mirage::compared() = {};
  const mirage::ImageView truth{width, height, reference};
  const std::optional<mirage::FlipMap> map = mirage::flip_map(truth, {width, height, test});
  if (!map) return out.flip.data();
  const mirage::Mask mask = mirage::covered(truth);
  const mirage::PicturePlace worst =
      mirage::flip_worst_place(*map, std::max(1U, height / mirage::kWorstOfHeight))
          .value_or(mirage::PicturePlace{-1, -1, -1});
  out.flip = {mirage::flip_mean(*map).value_or(-1),
              mirage::flip_mean(*map, mask).value_or(-1),
              mirage::flip_quantile(*map, mask, 0.99).value_or(-1),
              worst.x,
              worst.y,
              worst.flip};
  out.heat = mirage::heat_map(*map);
  return out.flip.data();
}
/// Returns the map of the last measurement as RGBA; nullptr: there is none.
EMSCRIPTEN_KEEPALIVE const std::uint8_t* picture_heat() {
  const mirage::Compared& last = mirage::compared();
  return last.heat.empty() ? nullptr : last.heat.data();
}

}  // extern "C"
