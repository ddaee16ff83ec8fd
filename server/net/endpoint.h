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
struct SceneChoice;
class SessionHub;
struct StageQueues;

/// Functions that run() calls.
struct EndpointHooks {
  /// after Endpoint::reload(), with the certificate already read again
  std::function<void()> reload;
  std::function<void()> tick;      ///< four times a second
  std::function<void()> stopping;  ///< once, when draining begins
  /// when a client asks for another choice of the scene. It returns the hub that shows it; nullptr:
  /// it is being loaded, and add() or give_up() follows. An error is told to the client.
  std::function<Result<SessionHub*>(const SceneChoice&)> choose;
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
  /// Adds the hub of another choice of the scene, on the thread of run(). The clients that wait for
  /// it go there.
  void add(const SceneChoice& choice, SessionHub& hub, StageQueues& queues);
  /// Closes the clients that wait for a choice, with an error, on the thread of run().
  void give_up(const SceneChoice& choice, const Error& error);
  /// Removes a hub that add() added and that has no client. It is not used any more.
  void remove(const SessionHub& hub);
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
