#pragma once
// Test WebSocket: its client sends what the test wants, right or wrong.

#include <cstdint>
#include <optional>
#include <string>

#include "tests/support/raw_peer.h"

namespace mirage::test {

/// A client's WebSocket packet under construction; unchanged it is a right one.
struct ClientFrame {
  int opcode = 2;
  std::string payload;
  bool final = true;
  int reserved = 0;  ///< RSV1 is 4, RSV2 2, RSV3 1
  bool masked = true;
  std::uint32_t mask = 0x5af10c83;
  int length_bytes = 0;                        ///< 1, 3 or 9 bytes for the length; 0: the fewest
  std::optional<std::uint64_t> declared = {};  ///< a length that differs from the payload's
  std::string bytes() const;
};

struct ServerFrame {
  bool final = true, masked = false;
  int reserved = 0, opcode = 0;
  std::string payload;
  /// Returns the code of a close packet; 1005: it has none (RFC 6455, 7.4.1).
  int close_code() const;
};

/// The request of a handshake: a line, and headers, each with its line end.
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
  /// True if the server has accepted the upgrade.
  bool open() const { return answer_.rfind("HTTP/1.1 101", 0) == 0; }
  /// Returns the head of the answer to the upgrade; empty: none.
  const std::string& answer() const { return answer_; }
  void say(const std::string& bytes) { peer_.say(bytes); }
  void say(const ClientFrame& frame) { peer_.say(frame.bytes()); }
  /// Returns the next packet of any kind; nullopt: none within `wait_ms`, or the server has closed:
  /// then ended().
  std::optional<ServerFrame> next(int wait_ms);
  bool ended() const { return peer_.ended(); }
  RawPeer& peer() { return peer_; }

 private:
  std::optional<ServerFrame> take_frame();

  RawPeer peer_;
  std::string answer_, heard_;
};

}  // namespace mirage::test
