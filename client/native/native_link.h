#pragma once
// Native link: a WebSocket client on its own thread (libwebsockets).
// Input:  messages to send.
// Output: decoded and unpacked messages.
// Thread: its own; a second one unpacks (unpacker.h).
// Full:   it stops reading when too many messages are not taken (back-pressure through TCP). Outbound
//         messages beyond the queue are dropped, and count as a broken link.

#include <functional>
#include <memory>
#include <optional>
#include <string>

#include "client/link/link.h"
#include "client/native/server_url.h"

namespace mirage {

class NativeLink final : public Link {
 public:
  /// Starts connecting, and reconnects with growing pauses until it is destroyed. The network
  /// thread calls `arrived` when a message can be received, or when the link goes up or down.
  /// `packed`: messages are passed on as they came, for programs that keep them.
  explicit NativeLink(const ServerUrl& url, std::function<void()> arrived = nullptr,
                      bool packed = false);
  ~NativeLink() override;

  void send(Bytes message) override;
  std::vector<Message> receive() override;
  bool connected() const override;
  std::uint32_t generation() const override;
  LinkTraffic traffic() const override;

  /// Closes the connection and opens another one.
  void reconnect();
  /// Waits until connected or until the time is over. Returns true if connected.
  bool wait_connected(int timeout_ms) const;
  /// Waits until something has arrived, the link has gone down, or the time is over.
  void wait_message(int timeout_ms) const;
  /// Returns why the last connection failed or was closed; empty: all is well.
  std::string last_problem() const;
  /// Returns the error of the last message that this client refused; it closed the connection for
  /// it.
  std::optional<Error> refusal() const;
  /// Returns the code with which the server closed (4003: token refused …); 0: none.
  int last_close_code() const;

  struct Impl;

 private:
  std::unique_ptr<Impl> impl_;
};

}  // namespace mirage
