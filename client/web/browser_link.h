#pragma once
// Link over the browser's WebSocket. The socket is a worker's (socket_worker.cpp), which puts
// chunks together, unpacks what takes long and stamps what came; the page hands both ways through.
// Thread: the page's. Never full: what comes is bounded by what was asked for.

#include <functional>
#include <utility>
#include <vector>

#include "client/link/link.h"

namespace mirage {

class BrowserLink final : public Link {
 public:
  /// `write` hands a whole message to the socket.
  explicit BrowserLink(std::function<void(const Bytes&)> write) : write_(std::move(write)) {}

  void send(Bytes message) override;
  std::vector<Message> receive() override { return std::exchange(inbound_, {}); }
  bool connected() const override { return connected_; }
  std::uint32_t generation() const override { return generation_; }
  LinkTraffic traffic() const override { return traffic_; }

  /// The socket is open, or closed: what came over the old one is dropped.
  void set_connected(bool connected);
  /// A message as the worker hands it on: `control` is a message without its payload, `payload` as
  /// unpack() left it. Error: the control part is damaged.
  struct Arrival {
    const std::uint8_t* control = nullptr;
    std::size_t control_bytes = 0;
    const std::uint8_t* payload = nullptr;
    std::size_t payload_bytes = 0;
    std::size_t packed_bytes = 0;  ///< of the payload, as it came
    std::size_t wire_bytes = 0;    ///< of the message, as it came
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

}  // namespace mirage
