#pragma once
// A WebSocket whose client says what it is told to, right or wrong.

#include <cstdint>
#include <optional>
#include <string>

#include "tests/support/raw_peer.h"

namespace mirage::test {

/// A client's frame as it is put together; as it is, a right one.
struct ClientFrame {
  int opcode = 2;
  std::string payload;
  bool final = true;
  int reserved = 0;  ///< RSV1 is 4, RSV2 2, RSV3 1
  bool masked = true;
  std::uint32_t mask = 0x5af10c83;
  int length_bytes = 0;                        ///< 1, 3 or 9 that tell the length; 0: the fewest
  std::optional<std::uint64_t> declared = {};  ///< another length than the payload's
  std::string bytes() const;
};

struct ServerFrame {
  bool final = true, masked = false;
  int reserved = 0, opcode = 0;
  std::string payload;
  /// Of a close frame; 1005: it gives none (RFC 6455, 7.4.1).
  int close_code() const;
};

/// The request of a handshake: a line, and headers each with its line's end.
struct Upgrade {
  std::string line = "GET / HTTP/1.1\r\n";
  std::string host = "Host: x\r\n";
  std::string upgrade = "Upgrade: websocket\r\n";
  std::string connection = "Connection: Upgrade\r\n";
  std::string protocol = "Sec-WebSocket-Protocol: mirage\r\n";
  std::string version = "Sec-WebSocket-Version: 13\r\n";
  std::string key = "Sec-WebSocket-Key: dGhlIHNhbXBsZSBub25jZQ==\r\n";
  std::string more;
  std::string bytes() const;
};

class WebSocket {
 public:
  explicit WebSocket(int port, const PeerFrom& from = {}, const Upgrade& request = {});
  /// The server has taken the upgrade.
  bool open() const { return answer_.rfind("HTTP/1.1 101", 0) == 0; }
  /// The head of what it answered to the upgrade; empty: nothing.
  const std::string& answer() const { return answer_; }
  void say(const std::string& bytes) { peer_.say(bytes); }
  void say(const ClientFrame& frame) { peer_.say(frame.bytes()); }
  /// The next frame, whatever it is; none within `wait_ms`, or the server has closed: then ended().
  std::optional<ServerFrame> next(int wait_ms);
  bool ended() const { return peer_.ended(); }
  RawPeer& peer() { return peer_; }

 private:
  std::optional<ServerFrame> take_frame();

  RawPeer peer_;
  std::string answer_, heard_;
};

}  // namespace mirage::test
