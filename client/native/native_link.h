#pragma once
// Native link: a WebSocket client on its own thread (libwebsockets).
// Input:  messages to send. Output: decoded messages. Thread: its own.
// Full:   the inbound queue stops reading (back-pressure through TCP); outbound messages beyond the
//         queue are dropped and counted as a broken link.

#include <functional>
#include <memory>
#include <optional>
#include <string>

#include "client/link/link.h"
#include "client/native/server_url.h"

namespace mirage {

class NativeLink final : public Link {
 public:
  /// Starts connecting, and reconnects with growing pauses until destroyed. `arrived` is called on
  /// the network's thread when a message is there to receive, or the link goes up or down.
  explicit NativeLink(const ServerUrl& url, std::function<void()> arrived = nullptr);
  ~NativeLink() override;

  void send(Bytes message) override;
  std::vector<Message> receive() override;
  bool connected() const override;
  std::uint32_t generation() const override;
  LinkTraffic traffic() const override;

  /// Waits until connected or the time is over.
  bool wait_connected(int timeout_ms) const;
  /// Waits until something has arrived, the link has gone down, or the time is over.
  void wait_message(int timeout_ms) const;
  /// Why the last connection failed or was closed; empty while all is well.
  std::string last_problem() const;
  /// The last message of the server that this client refused (and closed the connection for).
  std::optional<Error> refusal() const;
  /// The server closed with this code (4003: token refused …); 0: none.
  int last_close_code() const;

  struct Impl;

 private:
  std::unique_ptr<Impl> impl_;
};

}  // namespace mirage
