#pragma once
// Browser link: a link over the browser's WebSocket. A worker (socket_worker.cpp) owns the socket;
// it joins chunks, unpacks what takes long, and stamps arrivals. The page passes both directions
// through.
// Input:  messages to send; messages from the worker.
// Output: messages for the worker; received messages.
// Thread: the page's.
// Full:   never; arrivals are limited by what was asked for.

#include <functional>
#include <utility>
#include <vector>

#include "client/link/link.h"

namespace mirage {

class BrowserLink final : public Link {
 public:
  /// `write` passes a whole message to the socket.
  explicit BrowserLink(std::function<void(const Bytes&)> write) : write_(std::move(write)) {}

  void send(Bytes message) override;
  std::vector<Message> receive() override { return std::exchange(inbound_, {}); }
  bool connected() const override { return connected_; }
  std::uint32_t generation() const override { return generation_; }
  LinkTraffic traffic() const override { return traffic_; }

  /// Notes that the socket has opened or closed. Messages of the old connection are dropped.
  void set_connected(bool connected);
  /// A message as the worker passes it on. `control` is the message without its payload; `payload`
  /// is as unpack() left it. Error: the control part is damaged.
  struct Arrival {
    const std::uint8_t* control = nullptr;
    std::size_t control_bytes = 0;
    const std::uint8_t* payload = nullptr;
    std::size_t payload_bytes = 0;
    std::size_t packed_bytes = 0;  ///< bytes of the payload on the wire
    std::size_t wire_bytes = 0;    ///< bytes of the message on the wire
    std::int64_t waited_us = 0;
  };
  Result<void> arrived(const Arrival& arrival);
  bool waiting() const { return !inbound_.empty(); }

 private:
  std::function<void(const Bytes&)> write_;
  std::vector<Message> inbound_;
  bool connected_ = false;
  std::uint32_t generation_ = 0;
  LinkTraffic traffic_;
};

/// Passes a whole message to the socket by the module's function `write`, which the page sets.
void write_to_socket(const Bytes& message);

}  // namespace mirage
