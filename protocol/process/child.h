#pragma once
// Child processes: runs other programs to their end, or starts them.

#include <functional>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "protocol/base/result.h"

namespace mirage {

struct ChildResult {
  int exit_code = -1;  ///< 128 + signal if a signal ended it
  std::string out, err;
};

enum class ChildKind {
  kOurs,       ///< it gets this process's environment
  kForOthers,  ///< without the options in it (MIRAGE_…), and the time that others leave
};

/// The wishes of whoever runs a child.
struct ChildWatch {
  /// Each gets the lines of a stream soon after they are written.
  std::function<void(const std::string&)> on_out, on_err;
  std::function<bool()> wanted;  ///< false: the child is ended
  ChildKind kind = ChildKind::kOurs;
};

/// Runs the program with this path to its end, with an empty standard input. The exit code is 127
/// if there is no such program. The child is ended (SIGTERM) when this process ends, however that
/// happens. Error kIo if no process can be made.
Result<ChildResult> run_child(const std::vector<std::string>& command,
                              const ChildWatch& watch = {});

/// Starts a program with its standard output and error in files, because a full pipe that nobody
/// reads would stop it. Returns its process. Error kIo.
Result<int> start_child(const std::vector<std::string>& command, const std::string& out,
                        const std::string& err, ChildKind kind = ChildKind::kOurs);
/// Returns the exit code of a child that has ended, as in ChildResult; nullopt: it runs.
std::optional<int> ended_child(int process);
/// Ends a child: SIGTERM, and SIGKILL if it still runs ten seconds later.
void end_child(int process);

/// A new folder for temporary files, which goes with its content. Error kIo.
class ScratchFolder {
 public:
  static Result<ScratchFolder> make();
  ScratchFolder(ScratchFolder&& other) noexcept : path_(std::exchange(other.path_, {})) {}
  ScratchFolder& operator=(ScratchFolder&& other) noexcept {
    std::swap(path_, other.path_);
    return *this;
  }
  ~ScratchFolder();
  const std::string& path() const { return path_; }

 private:
  explicit ScratchFolder(std::string path) : path_(std::move(path)) {}
  std::string path_;
};

/// Returns the bytes of a file; empty: it is not there.
std::string read_whole_file(const std::string& path);

/// Returns the error in the `error <id>: <text>` line of what one of our programs wrote; nullopt:
/// there is none.
std::optional<Error> error_said(const std::string& text);

/// Returns the first executable of that name in PATH; nullopt: there is none.
std::optional<std::string> find_program(const std::string& name);
/// Returns the path of a program in this program's folder; nullopt: it is not there.
std::optional<std::string> sibling_program(const std::string& name);

}  // namespace mirage
