#pragma once
// Raw peer: a raw TCP connection to a server, for saying what no client library would.

#include <arpa/inet.h>
#include <netinet/in.h>
#include <poll.h>
#include <sys/socket.h>
#include <unistd.h>

#include <cstdint>
#include <string>

namespace mirage::test {

/// Options of a peer's connection.
struct PeerFrom {
  std::string address = "127.0.0.1";  ///< its own; all of 127.0.0.0/8 belong to this machine
  int receive_bytes = 0;              ///< of its receive buffer; 0: the usual
};

class RawPeer {
 public:
  explicit RawPeer(int port, const PeerFrom& from = {}) : socket_(socket(AF_INET, SOCK_STREAM, 0)) {
    if (from.receive_bytes > 0) {
      setsockopt(socket_, SOL_SOCKET, SO_RCVBUF, &from.receive_bytes, sizeof(int));
    }
    sockaddr_in address{};
    address.sin_family = AF_INET;
    address.sin_addr.s_addr = inet_addr(from.address.c_str());
    bind(socket_, reinterpret_cast<sockaddr*>(&address), sizeof(address));
    address.sin_port = htons(static_cast<std::uint16_t>(port));
    address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    connected_ = connect(socket_, reinterpret_cast<sockaddr*>(&address), sizeof(address)) == 0;
    wait_at_most(2);
    // A server that takes nothing more must not hold up a test.
    const timeval limit{1, 0};
    setsockopt(socket_, SOL_SOCKET, SO_SNDTIMEO, &limit, sizeof(limit));
  }
  ~RawPeer() { close(socket_); }
  RawPeer(const RawPeer&) = delete;
  RawPeer& operator=(const RawPeer&) = delete;
  bool connected() const { return connected_; }
  /// Sets how long hear() waits, seconds.
  void wait_at_most(int seconds) {
    timeval limit{seconds, 0};
    setsockopt(socket_, SOL_SOCKET, SO_RCVTIMEO, &limit, sizeof(limit));
  }
  void say(const std::string& bytes) {
    [[maybe_unused]] const ssize_t n = send(socket_, bytes.data(), bytes.size(), MSG_NOSIGNAL);
  }
  std::string hear() {
    char buffer[4096];
    const ssize_t n = recv(socket_, buffer, sizeof(buffer), 0);
    return n > 0 ? std::string(buffer, static_cast<std::size_t>(n)) : "";
  }
  /// Returns what has arrived within this many ms; also empty once the other side has closed: then
  /// ended().
  std::string hear_within(int ms, std::size_t most_bytes = 65536) {
    pollfd waiting{socket_, POLLIN, 0};
    if (poll(&waiting, 1, ms) <= 0) return "";
    std::string buffer(most_bytes, '\0');
    const ssize_t n = recv(socket_, buffer.data(), buffer.size(), 0);
    ended_ = n <= 0;
    buffer.resize(n > 0 ? static_cast<std::size_t>(n) : 0);
    return buffer;
  }
  bool ended() const { return ended_; }
  /// True if the other side has closed; what it says meanwhile is dropped.
  bool closed() {
    char buffer[4096];
    for (;;) {
      const ssize_t n = recv(socket_, buffer, sizeof(buffer), MSG_DONTWAIT);
      if (n > 0) continue;
      return n == 0 || (errno != EAGAIN && errno != EWOULDBLOCK && errno != EINTR);
    }
  }

 private:
  int socket_;
  bool connected_ = false, ended_ = false;
};

inline std::string upgrade(const std::string& version, const std::string& key) {
  return "GET / HTTP/1.1\r\nHost: x\r\nUpgrade: websocket\r\nConnection: Upgrade\r\n"
         "Sec-WebSocket-Protocol: mirage\r\nSec-WebSocket-Version: " +
         version + "\r\nSec-WebSocket-Key: " + key + "\r\n\r\n";
}
inline constexpr const char* kUpgradeKey = "dGhlIHNhbXBsZSBub25jZQ==";

/// Returns the head of a masked client packet of any length (mask 0: the payload stays readable).
inline std::string frame_head(int opcode, std::uint64_t length) {
  std::string out(1, static_cast<char>(0x80 | opcode));
  const int bytes = length < 126 ? 0 : length < 65536 ? 2 : 8;
  const std::uint64_t code = bytes == 0 ? length : bytes == 2 ? 126 : 127;
  out += static_cast<char>(0x80 | code);
  for (int i = bytes - 1; i >= 0; --i) out += static_cast<char>(length >> (8 * i) & 0xff);
  return out + std::string(4, '\0');
}
inline std::string frame(int opcode, const std::string& payload) {
  return frame_head(opcode, payload.size()) + payload;
}

}  // namespace mirage::test
