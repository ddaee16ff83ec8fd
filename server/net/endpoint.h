#pragma once
// Endpoint: the libwebsockets loop; it turns bytes into messages and back.
// Input:  sockets
// Output: calls into the SessionHub
// Thread: the caller's of run() (main)
// Full:   writes only when a socket accepts data; a slow reader fills its own outbox

#include <functional>
#include <memory>
#include <string>

#include "protocol/base/result.h"

namespace mirage {

struct EndpointOptions;
class SessionHub;
struct StageQueues;

/// Functions that run() calls.
struct EndpointHooks {
  /// after Endpoint::reload(), with the certificate already read again
  std::function<void()> reload;
  std::function<void()> tick;      ///< four times a second
  std::function<void()> stopping;  ///< once, when draining begins
};

class Endpoint {
 public:
  Endpoint(SessionHub& hub, StageQueues& queues);
  ~Endpoint();
  Endpoint(const Endpoint&) = delete;
  Endpoint& operator=(const Endpoint&) = delete;

  /// Binds and listens. Error kNetworkListen.
  Result<void> listen(const EndpointOptions& options);
  /// Returns the port in use; 0 for a unix socket.
  int port() const;
  /// Switches to the hub of another scene, on the thread of run(). Clients are closed with 1001 and
  /// come back to the new hub. The old hub is not used any more.
  void serve(SessionHub& hub, StageQueues& queues);
  /// Serves until stop() or until the renderer fails, then says goodbye to the clients. Returns the
  /// renderer's error, if any.
  Result<void> run(EndpointHooks hooks = {});
  /// Ends run(). Any thread, also a signal handler.
  void stop();
  /// Makes run() call the reload hook. Any thread, also a signal handler.
  void reload();
  /// Tells run() that there are completions. Any thread.
  void wake();

  struct Impl;

 private:
  std::unique_ptr<Impl> impl_;
};

}  // namespace mirage
