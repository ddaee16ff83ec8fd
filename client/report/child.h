#pragma once
// Child processes: other programs run to their end, and servers of our own.

#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "protocol/base/result.h"

namespace mirage {

struct ChildResult {
  int exit_code = -1;  ///< 128 + signal when one killed it
  std::string out, err;
};

/// Runs a program, given by its path, to its end, nothing on its standard input; exit code 127 when
/// there is none. `on_line` gets each line of its standard output soon after it is written. Error
/// kIo when no process can be made.
Result<ChildResult> run_child(const std::vector<std::string>& command,
                              const std::function<void(const std::string&)>& on_line = {});

/// First executable of that name in PATH; nullopt when there is none.
std::optional<std::string> find_program(const std::string& name);
/// Path of a program beside this one; nullopt when it is not there.
std::optional<std::string> sibling_program(const std::string& name);

/// A mirage-server of our own on a free port of the loopback; ended (SIGTERM) on destruction.
class ServerProcess {
 public:
  ~ServerProcess();
  ServerProcess(const ServerProcess&) = delete;
  ServerProcess& operator=(const ServerProcess&) = delete;

  /// Waits until it is ready; `more` are further options. Errors: what the server said itself, kIo
  /// when it is not there, kNetworkTimeout.
  static Result<std::unique_ptr<ServerProcess>> start(const std::string& scene,
                                                      const std::string& device,
                                                      const std::vector<std::string>& more = {});
  std::string url() const { return "ws://127.0.0.1:" + std::to_string(port_); }
  /// From its start to its `ready` line, seconds of the wall clock.
  double ready_s() const { return ready_s_; }
  /// The most memory it has held so far, MB (10^6 bytes); nullopt where the system does not tell.
  std::optional<double> peak_mb() const;
  /// The value of a `key=value` of its `ready` line; empty when there is none.
  std::string ready_value(const std::string& key) const;
  /// What it warned of when it loaded the scene, a line each.
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
