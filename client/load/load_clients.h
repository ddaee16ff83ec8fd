#pragma once
// Load clients: many WebSocket clients on one libwebsockets context.
// Input:  messages to send.
// Output: calls of the sink, made from within service().
// Thread: the caller's only; nothing happens outside service().
// Full:   outbound messages wait until their socket is writable. Inbound ones are limited by
//         limits.h, and handed on at once.

#include <memory>
#include <string>

#include "client/native/native_link.h"

namespace mirage {

/// Receives events. Bytes are valid during the call only. An error closes the connection, as its
/// cause.
class LoadSink {
 public:
  virtual ~LoadSink() = default;
  virtual void on_open(std::uint32_t client) = 0;
  virtual Result<void> on_message(std::uint32_t client, const std::uint8_t* bytes,
                                  std::size_t size) = 0;
  /// Called once for every connect(), unless close_all() ended it. `id` is stable: an error id, or
  /// "closed-CODE" with the server's WebSocket close code.
  virtual void on_down(std::uint32_t client, const std::string& id, const std::string& text) = 0;
};

class LoadClients {
 public:
  /// Creates the clients, and raises the limit on open files as far as needed. Errors: kUsage if
  /// that is not allowed, kInternal if libwebsockets does not start.
  static Result<std::unique_ptr<LoadClients>> create(const ServerUrl& url, std::uint32_t count,
                                                     LoadSink& sink);
  ~LoadClients();

  void connect(std::uint32_t client);
  void send(std::uint32_t client, Bytes message);
  /// Handles waiting events, or waits at most `wait_us` for one, to about a millisecond.
  void service(std::int64_t wait_us);
  /// Says goodbye on all connections, and waits at most `wait_us` for the answers.
  void close_all(std::int64_t wait_us);
  /// Returns the bytes of WebSocket messages received.
  std::uint64_t bytes() const;

  struct Impl;

 private:
  explicit LoadClients(std::unique_ptr<Impl> impl);
  std::unique_ptr<Impl> impl_;
};

}  // namespace mirage
