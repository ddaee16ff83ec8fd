// Socket worker: the code of the worker that owns the socket, or a frozen folder in its place. It
// takes WebSocket packets, or files, and returns whole, unpacked messages. socket_worker.js calls
// the exports; returned memory belongs to this side, and is valid until the next call.

#include <emscripten.h>

#include <array>
#include <deque>
#include <optional>
#include <string>

#include "client/folder/folder_server.h"
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
  FolderServer folder;
  std::deque<Bytes> answers;  // of the folder
  std::deque<std::string> fetches, holes;
  std::string name;  // handed out last
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

// Takes what the folder wants and answers.
void collect(Socket& s) {
  for (Bytes& answer : s.folder.take_messages()) s.answers.push_back(std::move(answer));
  for (std::string& name : s.folder.take_fetches()) s.fetches.push_back(std::move(name));
  for (std::string& name : s.folder.take_holes()) s.holes.push_back(std::move(name));
}

const char* next(std::deque<std::string>& names, Socket& s) {
  if (names.empty()) return nullptr;
  s.name = std::move(names.front());
  names.pop_front();
  return s.name.c_str();
}

// Returns the words of socket_accept() for a whole message.
const std::int32_t* words(const Bytes& whole, std::size_t wire_bytes, Socket& s) {
  static std::array<std::int32_t, 7> out;
  out = {};
  if (Result<void> taken = take(whole, s); !taken) {
    s.problem = taken.error().text;
    out[0] = -1;
    return out.data();
  }
  const auto at = [](const Bytes& bytes) {
    return static_cast<std::int32_t>(reinterpret_cast<std::intptr_t>(bytes.data()));
  };
  const std::size_t packed = whole.size() - s.control.size();
  out = {1,
         at(s.control),
         static_cast<std::int32_t>(s.control.size()),
         at(s.payload),
         static_cast<std::int32_t>(s.payload.size()),
         static_cast<std::int32_t>(packed),
         static_cast<std::int32_t>(wire_bytes)};
  return out.data();
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
  mirage::Result<std::optional<Bytes>> whole = s.assembler.accept(bytes, size);
  if (!whole) {
    s.problem = whole.error().text;
    out[0] = -1;
    return out.data();
  }
  if (!whole->has_value()) return out.data();
  return mirage::words(**whole, std::exchange(s.wire_bytes, 0), s);
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

/// Opens a frozen folder by its frozen.bin. Returns 0, or -1 if it was refused.
EMSCRIPTEN_KEEPALIVE int folder_open(const std::uint8_t* bytes, std::size_t size) {
  socket() = {};
  const mirage::Result<void> opened = socket().folder.open(Bytes(bytes, bytes + size));
  if (!opened) socket().problem = opened.error().text;
  return opened ? 0 : -1;
}
/// Takes a message for the folder; a client of this build says nothing that cannot be read.
EMSCRIPTEN_KEEPALIVE void folder_ask(const std::uint8_t* bytes, std::size_t size) {
  (void)socket().folder.ask(bytes, size);
  mirage::collect(socket());
}
/// Takes a file that was fetched; nullptr: there is none.
EMSCRIPTEN_KEEPALIVE void folder_fetched(const char* name, const std::uint8_t* bytes,
                                         std::size_t size) {
  const Bytes file(bytes, bytes + size);
  socket().folder.fetched(name, bytes ? &file : nullptr);
  mirage::collect(socket());
}
/// Return the next file to fetch, and the next that is missing or damaged; nullptr: none.
EMSCRIPTEN_KEEPALIVE const char* folder_next_fetch() {
  return mirage::next(socket().fetches, socket());
}
EMSCRIPTEN_KEEPALIVE const char* folder_next_hole() {
  return mirage::next(socket().holes, socket());
}
/// Returns the words of socket_accept() for the folder's next message.
EMSCRIPTEN_KEEPALIVE const std::int32_t* folder_next_message() {
  static const std::array<std::int32_t, 7> nothing{};
  mirage::Socket& s = socket();
  if (s.answers.empty()) return nothing.data();
  const Bytes whole = std::move(s.answers.front());
  s.answers.pop_front();
  return mirage::words(whole, whole.size(), s);
}

}  // extern "C"
