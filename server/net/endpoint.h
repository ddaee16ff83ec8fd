#pragma once
// Endpoint: the libwebsockets loop; bytes to messages and back. The only server file that knows
// libwebsockets.
// Input:  sockets. Output: calls into the SessionHub. Thread: the caller's of run() (main).
// Full:   writes only when a socket can take it; a slow reader fills its own outbox.

#include <functional>
#include <memory>
#include <string>

#include "protocol/base/result.h"

namespace mirage {

struct EndpointOptions;
class SessionHub;
struct StageQueues;

/// Called by run().
struct EndpointHooks {
  std::function<void()> reload;  ///< after Endpoint::reload(); the certificate is read anew by then
  std::function<void()> tick;    ///< four times a second
  std::function<void()> stopping;  ///< once, as it begins to drain
};

class Endpoint {
 public:
  Endpoint(SessionHub& hub, StageQueues& queues);
  ~Endpoint();
  Endpoint(const Endpoint&) = delete;
  Endpoint& operator=(const Endpoint&) = delete;

  /// Binds and listens. Error kNetworkListen.
  Result<void> listen(const EndpointOptions& options);
  /// The one taken; of a unix socket 0.
  int port() const;
  /// Another scene's from now on, on the thread of run(): clients are closed, with 1001, and
  /// come back to these. What was served before is not used any more.
  void serve(SessionHub& hub, StageQueues& queues);
  /// Serves until stop(); then says goodbye to the clients and returns. So it does when the
  /// renderer fails, with its error.
  Result<void> run(EndpointHooks hooks = {});
  /// Any thread, also from a signal handler.
  void stop();
  /// Any thread and signal handlers: has the hook called in run().
  void reload();
  /// Any thread: there are completions.
  void wake();

  struct Impl;

 private:
  std::unique_ptr<Impl> impl_;
};

}  // namespace mirage
