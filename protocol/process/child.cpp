#include "protocol/process/child.h"

#include <fcntl.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cerrno>
#include <chrono>
#include <csignal>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <sstream>
#include <thread>

namespace mirage {
namespace {

namespace fs = std::filesystem;

constexpr int kCannotRun = 127;
constexpr std::chrono::milliseconds kStopPatience{10'000}, kStopPause{20}, kPause{20};
constexpr int kLowestPriority = 19;

int status_to_code(int status) {
  return WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
}

// Returns the environment of this process, without the options that it holds.
std::vector<char*> environment_without_options() {
  std::vector<char*> out;
  for (char** one = environ; *one != nullptr; ++one) {
    if (std::strncmp(*one, "MIRAGE_", 7) != 0) out.push_back(*one);
  }
  out.push_back(nullptr);
  return out;
}

// Passes on the whole lines that a file has gained since the last call.
void pass_lines(std::ifstream& file, const std::function<void(const std::string&)>& on_line) {
  std::string line;
  while (true) {
    const std::streampos start = file.tellg();
    if (!std::getline(file, line) || file.eof()) {
      file.clear();
      file.seekg(start);
      return;
    }
    on_line(line);
  }
}

}  // namespace

std::optional<Error> error_said(const std::string& text) {
  std::istringstream lines(text);
  std::string line;
  while (std::getline(lines, line)) {
    if (line.rfind("error ", 0) != 0) continue;
    const std::size_t colon = line.find(": ");
    if (colon == std::string::npos) continue;
    const std::string id = line.substr(6, colon - 6);
#define MIRAGE_X(e, text_id, exit, close, cause, cure) \
  if (id == (text_id)) return make_error(ErrorId::e, line.substr(colon + 2));
    MIRAGE_ERRORS(MIRAGE_X)
#undef MIRAGE_X
  }
  return std::nullopt;
}

Result<int> start_child(const std::vector<std::string>& command, const std::string& out,
                        const std::string& err, ChildKind kind) {
  std::vector<char*> argv;
  argv.reserve(command.size() + 1);
  for (const std::string& word : command) argv.push_back(const_cast<char*>(word.c_str()));
  argv.push_back(nullptr);
  std::vector<char*> without = environment_without_options();
  char** const environment = kind == ChildKind::kOurs ? environ : without.data();
  const int write_new = O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC;
  const int files[] = {open("/dev/null", O_RDONLY | O_CLOEXEC), open(out.c_str(), write_new, 0600),
                       open(err.c_str(), write_new, 0600)};
  const int parent = getpid();
  const int pid = fork();
  if (pid == 0) {  // only calls that are allowed between fork and exec
    prctl(PR_SET_PDEATHSIG, SIGTERM);
    if (getppid() != parent) _exit(kCannotRun);
    if (kind == ChildKind::kForOthers) setpriority(PRIO_PROCESS, 0, kLowestPriority);
    for (int i = 0; i < 3; ++i) dup2(files[i], i);
    execve(argv[0], argv.data(), environment);
    _exit(kCannotRun);
  }
  for (const int file : files) close(file);
  if (pid < 0) {
    return make_error(ErrorId::kIo, "cannot run '" + command[0] + "': " + std::strerror(errno));
  }
  return pid;
}

std::optional<int> ended_child(int process) {
  int status = 0;
  if (waitpid(process, &status, WNOHANG) != process) return std::nullopt;
  return status_to_code(status);
}

void end_child(int process) {
  kill(process, SIGTERM);
  for (auto waited = std::chrono::milliseconds(0); waited < kStopPatience; waited += kStopPause) {
    if (ended_child(process)) return;
    std::this_thread::sleep_for(kStopPause);
  }
  kill(process, SIGKILL);
  int status = 0;
  waitpid(process, &status, 0);
}

Result<ScratchFolder> ScratchFolder::make() {
  std::error_code failed;
  std::string name = (fs::temp_directory_path(failed) / "mirage-child-XXXXXX").string();
  if (failed || !mkdtemp(name.data())) {
    return make_error(ErrorId::kIo, "cannot make a folder for temporary files");
  }
  return ScratchFolder(name);
}

ScratchFolder::~ScratchFolder() {
  std::error_code ignored;
  if (!path_.empty()) fs::remove_all(path_, ignored);
}

std::string read_whole_file(const std::string& path) {
  std::ifstream file(path, std::ios::binary);
  std::ostringstream text;
  text << file.rdbuf();
  return text.str();
}

Result<ChildResult> run_child(const std::vector<std::string>& command, const ChildWatch& watch) {
  const Result<ScratchFolder> folder = ScratchFolder::make();
  if (!folder) return folder.error();
  const std::string out_file = folder->path() + "/out", err_file = folder->path() + "/err";
  const Result<int> process = start_child(command, out_file, err_file, watch.kind);
  if (!process) return process.error();
  std::ifstream out(out_file, std::ios::binary), err(err_file, std::ios::binary);
  const auto pass_on = [&] {
    if (watch.on_out) pass_lines(out, watch.on_out);
    if (watch.on_err) pass_lines(err, watch.on_err);
  };
  ChildResult result;
  std::optional<int> code;
  while (!(code = ended_child(*process))) {
    pass_on();
    if (watch.wanted && !watch.wanted()) {
      end_child(*process);
      code = 128 + SIGTERM;
      break;
    }
    std::this_thread::sleep_for(kPause);
  }
  pass_on();
  result.exit_code = *code;
  result.out = read_whole_file(out_file);
  result.err = read_whole_file(err_file);
  return result;
}

std::optional<std::string> find_program(const std::string& name) {
  const char* path = std::getenv("PATH");
  std::istringstream folders(path ? path : "");
  std::string folder;
  while (std::getline(folders, folder, ':')) {
    const std::string candidate = std::string(folder).append("/").append(name);
    if (!folder.empty() && access(candidate.c_str(), X_OK) == 0) return candidate;
  }
  return std::nullopt;
}

std::optional<std::string> sibling_program(const std::string& name) {
  std::error_code failed;
  const fs::path self = fs::read_symlink("/proc/self/exe", failed);
  if (failed) return std::nullopt;
  const std::string path = (self.parent_path() / name).string();
  if (access(path.c_str(), X_OK) != 0) return std::nullopt;
  return path;
}

}  // namespace mirage
