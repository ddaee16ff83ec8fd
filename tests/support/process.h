#pragma once
// Child processes for the end-to-end tests: the shipped binaries are the test subject.

#include <string>
#include <vector>

namespace mirage::test {

struct Finished {
  int exit_code = -1;  ///< 128 + signal if one ended it; -1: timed out and killed
  std::string output;  ///< standard output and error together
  double seconds = 0;
  double peak_mb = 0;  ///< largest resident memory, in 2^20 bytes
};

/// Runs a program to its end (at most `timeout_s`).
Finished run(const std::vector<std::string>& command, double timeout_s = 60);

/// Returns the path of a shipped binary: the program of that name beside this one.
std::string binary(const std::string& name);

/// Returns all bytes of a file; empty: it does not exist.
std::string read_file(const std::string& path);

/// Returns data_folder().
std::string shared_folder();

/// Returns a new folder for one test's files, removed at exit.
std::string scratch_folder();

/// A running mirage-server on a free port; stopped (SIGTERM) and reaped on destruction.
class Server {
 public:
  /// `environment`: NAME=value, in addition to the test's own.
  explicit Server(const std::string& scene, const std::vector<std::string>& extra = {},
                  const std::vector<std::string>& environment = {});
  ~Server();
  Server(const Server&) = delete;
  Server& operator=(const Server&) = delete;

  bool ready() const { return !url_.empty(); }
  int port() const { return port_; }  ///< 0: it listens on a unix socket
  int pid() const { return pid_; }
  const std::string& url() const { return url_; }
  /// Ends it with `signal`. Returns the exit code.
  int stop(int signal);
  /// Returns the exit code of a server that ends by itself; -1: it did not.
  int wait(double timeout_s);
  std::string log() const;

 private:
  int pid_ = -1;
  int port_ = 0;
  std::string url_;  ///< as its ready line says
  std::string folder_;
};

}  // namespace mirage::test
