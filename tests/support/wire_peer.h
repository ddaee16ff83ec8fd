#pragma once
// A client that speaks the protocol over a raw socket: what it sends is up to the test.

#include <chrono>
#include <deque>
#include <optional>
#include <string>
#include <utility>

#include "protocol/base/limits.h"
#include "protocol/impostor/tile_key.h"
#include "protocol/wire/message.h"
#include "tests/support/raw_peer.h"

namespace mirage::test {

class WirePeer {
 public:
  explicit WirePeer(int port) : peer_(port) {
    peer_.say(upgrade("13", kUpgradeKey));
    while (heard_.find("\r\n\r\n") == std::string::npos) {
      const std::string more = peer_.hear();
      if (more.empty()) return;
      heard_ += more;
    }
    open_ = heard_.rfind("HTTP/1.1 101", 0) == 0;
    heard_.erase(0, heard_.find("\r\n\r\n") + 4);
  }
  /// The server has taken the upgrade.
  bool open() const { return open_; }
  RawPeer& raw() { return peer_; }
  template <typename BodyT>
  void send(BodyT&& body) {
    const Bytes message = encode_message(std::forward<BodyT>(body));
    peer_.say(frame(2, std::string(message.begin(), message.end())));
  }
  void say_hello(const std::string& token = "") {
    wire::HelloT hello;
    hello.version_min = hello.version_max = limits::kProtocolVersion;
    hello.token = token;
    hello.codecs = {static_cast<std::uint8_t>(TileCodec::kZstd)};
    send(std::move(hello));
  }
  /// The next message; none within the peer's patience, or the server has closed.
  std::optional<Message> next() {
    for (;;) {
      while (std::optional<std::string> payload = take_frame()) {
        const auto* bytes = reinterpret_cast<const std::uint8_t*>(payload->data());
        Result<std::optional<Bytes>> whole = assembler_.accept(bytes, payload->size());
        if (!whole || !whole->has_value()) continue;
        Result<Message> message = decode_message((*whole)->data(), (*whole)->size());
        if (message) return message.take();
      }
      if (closed_) return std::nullopt;
      const std::string more = peer_.hear();
      if (more.empty()) return std::nullopt;
      heard_ += more;
    }
  }
  /// Of the server's close frame; 0: there was none.
  int close_code() const { return close_code_; }
  /// Asks for a tile of the first instance and waits for the answer, ms; < 0: none came.
  double ask_ms(std::uint32_t request, std::uint16_t x, std::uint8_t size_class) {
    const auto began = std::chrono::steady_clock::now();
    ask(request, x, size_class);
    while (const std::optional<Message> message = next()) {
      const wire::TileReplyT* tile = message->body.AsTileReply();
      const wire::RefusedT* refused = message->body.AsRefused();
      if ((!tile || tile->request_id != request) && (!refused || refused->request_id != request)) {
        continue;
      }
      const std::chrono::duration<double, std::milli> took =
          std::chrono::steady_clock::now() - began;
      return tile ? took.count() : -1;
    }
    return -1;
  }
  /// Of the first instance, from a view cell of the finest level in use here.
  void ask(std::uint32_t request, std::uint16_t x, std::uint8_t size_class) {
    wire::RequestBatchT batch;
    batch.asks = {wire::Ask(request, 0, 0, 1.0f, 0, 8, x, 0, 9, 2, size_class, kLitTile, 0)};
    batch.credit_bytes = std::uint64_t{1} << 40;
    send(std::move(batch));
  }

 private:
  /// The payload of a whole data frame; control frames are passed over.
  std::optional<std::string> take_frame() {
    for (;;) {
      if (heard_.size() < 2) return std::nullopt;
      const auto at = [&](std::size_t i) { return static_cast<std::uint8_t>(heard_[i]); };
      std::size_t head = 2;
      std::uint64_t length = at(1) & 0x7f;
      const int wide = length == 126 ? 2 : length == 127 ? 8 : 0;
      if (heard_.size() < head + static_cast<std::size_t>(wide)) return std::nullopt;
      if (wide > 0) length = 0;
      for (int i = 0; i < wide; ++i) length = length << 8 | at(head++);
      if (heard_.size() < head + length) return std::nullopt;
      const int opcode = at(0) & 0x0f;
      std::string payload = heard_.substr(head, length);
      heard_.erase(0, head + length);
      if (opcode == 2) return payload;
      closed_ = closed_ || opcode == 8;
      if (closed_ && payload.size() >= 2) {
        close_code_ =
            static_cast<std::uint8_t>(payload[0]) << 8 | static_cast<std::uint8_t>(payload[1]);
      }
    }
  }

  RawPeer peer_;
  std::string heard_;
  bool open_ = false, closed_ = false;
  int close_code_ = 0;
  FrameAssembler assembler_{limits::kMaxTransferBytes};
};

}  // namespace mirage::test
