#pragma once
// Server process: a mirage-server that a program starts for itself.

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "protocol/base/result.h"
#include "protocol/process/child.h"

namespace mirage {

/// A mirage-server on a free port of the loopback. Destruction ends it (SIGTERM).
class ServerProcess {
 public:
  ~ServerProcess();
  ServerProcess(const ServerProcess&) = delete;
  ServerProcess& operator=(const ServerProcess&) = delete;

  /// Starts a server and waits until it is ready. `more` are further options. Errors: the server's
  /// own, kIo if the program is not there, kNetworkTimeout.
  static Result<std::unique_ptr<ServerProcess>> start(const std::string& scene,
                                                      const std::string& device,
                                                      const std::vector<std::string>& more = {});
  int port() const { return port_; }
  std::string url() const { return "ws://127.0.0.1:" + std::to_string(port_); }
  /// Returns the seconds of the wall clock from its start to its `ready` line.
  double ready_s() const { return ready_s_; }
  /// Returns the most memory it has used so far, MB (10^6 bytes); nullopt if the system does not
  /// tell.
  std::optional<double> peak_mb() const;
  /// Returns the value of a `key=value` in its `ready` line; empty: there is none.
  std::string ready_value(const std::string& key) const;
  /// Returns the warnings that it printed while loading the scene, a line each.
  std::vector<std::string> scene_warnings() const;

 private:
  ServerProcess() = default;
  Result<void> wait_ready(const std::string& scene);
  std::string file(const std::string& name) const;

  int pid_ = -1;
  int port_ = 0;
  double ready_s_ = 0;
  std::optional<ScratchFolder> folder_;
};

}  // namespace mirage
