#pragma once
// Hostile client: a client that speaks the protocol over a raw socket; the test decides what it
// sends.

#include <chrono>
#include <cstdint>
#include <optional>
#include <string>
#include <utility>

#include "protocol/base/limits.h"
#include "protocol/wire/message.h"
#include "tests/hostile/web_socket.h"

namespace mirage::test {

inline std::string text_of(const Bytes& bytes) { return {bytes.begin(), bytes.end()}; }

inline double seconds_since(std::chrono::steady_clock::time_point start) {
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

wire::HelloT hello(const std::string& token = "");

/// Size classes of tiles: 64, 256 and 2048 texels.
inline constexpr std::uint8_t kSmall = 4, kMiddle = 8, kLargest = 14;

/// Returns an ask for a tile of the first instance that this program has not asked for before.
/// `error_px` is its worth, the largest first.
wire::Ask new_tile(std::uint32_t request, std::uint8_t size_class, std::uint32_t deadline_ms = 0,
                   float error_px = 1);

/// Returns a request for a render of the whole scene, one sample a pixel.
wire::ReferenceRequestT full_render(std::uint32_t request, std::uint32_t width,
                                    std::uint32_t height);

class Client {
 public:
  /// Says hello and takes in the scene's description, unless it is refused: then !greeted().
  explicit Client(int port, const std::string& token = "", const PeerFrom& from = {});
  bool greeted() const { return greeted_; }

  template <typename BodyT>
  void send(BodyT&& body) {
    socket_.say(ClientFrame{2, text_of(encode_message(std::forward<BodyT>(body)))});
  }
  /// Sends the asks, with credit for all of them.
  void ask(std::vector<wire::Ask> asks);
  /// Returns the next message; nullopt: none within `wait_ms`, or the server has closed.
  std::optional<Message> next(int wait_ms);
  /// Asks for a new tile and waits for it. Returns the ms; < 0: it did not arrive.
  double tile_ms(std::uint8_t size_class);
  /// Returns the code of the server's close packet; 0: none has arrived.
  int close_code() const { return close_code_; }
  WebSocket& socket() { return socket_; }

 private:
  WebSocket socket_;
  PacketAssembler assembler_{limits::kMaxTransferBytes};
  bool greeted_ = false;
  int close_code_ = 0;
  std::uint32_t request_ = 1u << 30;  ///< ids of tile_ms(), apart from a test's own
};

}  // namespace mirage::test
