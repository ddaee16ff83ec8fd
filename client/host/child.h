#pragma once
// Child processes: runs other programs to their end, and starts servers.

#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "protocol/base/result.h"

namespace mirage {

struct ChildResult {
  int exit_code = -1;  ///< 128 + signal if a signal ended it
  std::string out, err;
};

/// Runs the program with this path to its end, with an empty standard input. The exit code is 127
/// if there is no such program. `on_line` gets each line of its standard output soon after it is
/// written. Error kIo if no process can be made.
Result<ChildResult> run_child(const std::vector<std::string>& command,
                              const std::function<void(const std::string&)>& on_line = {});

/// Returns the error in the `error <id>: <text>` line of what one of our programs wrote; nullopt:
/// there is none.
std::optional<Error> error_said(const std::string& text);

/// Returns the first executable of that name in PATH; nullopt: there is none.
std::optional<std::string> find_program(const std::string& name);
/// Returns the path of a program in this program's folder; nullopt: it is not there.
std::optional<std::string> sibling_program(const std::string& name);

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
  void end();

  int pid_ = -1;
  int port_ = 0;
  double ready_s_ = 0;
  std::string folder_;
};

}  // namespace mirage
