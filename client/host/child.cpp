#include "client/host/child.h"

#include <fcntl.h>
#include <sys/prctl.h>
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

#include "protocol/base/clock.h"

namespace mirage {
namespace {

namespace fs = std::filesystem;

constexpr int kServerPatienceMs = 300'000;  // a large scene's levels of detail take minutes
constexpr int kCannotRun = 127;
constexpr int kStopPatienceMs = 10'000;
constexpr std::chrono::milliseconds kLinePause{100};

int status_to_code(int status) {
  return WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
}

// Starts a program with its standard output and error in files, because a full pipe that nobody
// reads would stop it. It gets SIGTERM when this process ends, however that happens.
Result<int> spawn(const std::vector<std::string>& command, const std::string& out,
                  const std::string& err) {
  std::vector<char*> argv;
  argv.reserve(command.size() + 1);
  for (const std::string& word : command) argv.push_back(const_cast<char*>(word.c_str()));
  argv.push_back(nullptr);
  const int write_new = O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC;
  const int files[] = {open("/dev/null", O_RDONLY | O_CLOEXEC), open(out.c_str(), write_new, 0600),
                       open(err.c_str(), write_new, 0600)};
  const int parent = getpid();
  const int pid = fork();
  if (pid == 0) {  // only calls that are allowed between fork and exec
    prctl(PR_SET_PDEATHSIG, SIGTERM);
    if (getppid() != parent) _exit(kCannotRun);
    for (int i = 0; i < 3; ++i) dup2(files[i], i);
    execv(argv[0], argv.data());
    _exit(kCannotRun);
  }
  for (const int file : files) close(file);
  if (pid < 0) {
    return make_error(ErrorId::kIo, "cannot run '" + command[0] + "': " + std::strerror(errno));
  }
  return pid;
}

std::string read_file(const std::string& path) {
  std::ifstream file(path, std::ios::binary);
  std::ostringstream text;
  text << file.rdbuf();
  return text.str();
}

Result<std::string> scratch_folder() {
  std::error_code failed;
  std::string name = (fs::temp_directory_path(failed) / "mirage-child-XXXXXX").string();
  if (failed || !mkdtemp(name.data())) {
    return make_error(ErrorId::kIo, "cannot make a folder for temporary files");
  }
  return name;
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

Result<ChildResult> run_child(const std::vector<std::string>& command,
                              const std::function<void(const std::string&)>& on_line) {
  Result<std::string> folder = scratch_folder();
  if (!folder) return folder.error();
  const Result<int> pid = spawn(command, *folder + "/out", *folder + "/err");
  ChildResult result;
  if (pid.ok()) {
    int status = 0;
    std::ifstream out(*folder + "/out", std::ios::binary);
    while (waitpid(*pid, &status, on_line ? WNOHANG : 0) == 0) {
      pass_lines(out, on_line);
      std::this_thread::sleep_for(kLinePause);
    }
    if (on_line) pass_lines(out, on_line);
    result = {status_to_code(status), read_file(*folder + "/out"), read_file(*folder + "/err")};
  }
  std::error_code ignored;
  fs::remove_all(*folder, ignored);
  if (!pid) return pid.error();
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

Result<std::unique_ptr<ServerProcess>> ServerProcess::start(const std::string& scene,
                                                            const std::string& device,
                                                            const std::vector<std::string>& more) {
  const std::optional<std::string> program = sibling_program("mirage-server");
  if (!program) {
    return make_error(ErrorId::kIo, "there is no mirage-server beside this program",
                      "build it, or give the address of one: --url ws://HOST:PORT");
  }
  Result<std::string> folder = scratch_folder();
  if (!folder) return folder.error();
  std::unique_ptr<ServerProcess> server(new ServerProcess);
  server->folder_ = *folder;
  std::vector<std::string> command = {*program,      scene,         "--listen",
                                      "127.0.0.1:0", "--port-file", *folder + "/port",
                                      "--device",    device};
  command.insert(command.end(), more.begin(), more.end());
  const SteadyClock clock;
  const Result<int> pid = spawn(command, *folder + "/out", *folder + "/err");
  if (!pid) return pid.error();
  server->pid_ = *pid;
  if (Result<void> ready = server->wait_ready(scene); !ready) return ready.error();
  server->ready_s_ = static_cast<double>(clock.now_us()) * 1e-6;
  return server;
}

std::optional<double> ServerProcess::peak_mb() const {
  std::istringstream status(read_file("/proc/" + std::to_string(pid_) + "/status"));
  std::string line;
  while (std::getline(status, line)) {
    if (line.rfind("VmHWM:", 0) == 0) return std::atof(line.c_str() + 6) * 1024 * 1e-6;
  }
  return std::nullopt;
}

std::string ServerProcess::ready_value(const std::string& key) const {
  std::istringstream words(read_file(folder_ + "/out"));
  std::string word;
  while (words >> word) {
    if (word.rfind(key + "=", 0) == 0) return word.substr(key.size() + 1);
  }
  return "";
}

std::vector<std::string> ServerProcess::scene_warnings() const {
  const std::string mark = "warning scene: ";
  std::istringstream lines(read_file(folder_ + "/err"));
  std::vector<std::string> out;
  std::string line;
  while (std::getline(lines, line)) {
    if (const std::size_t at = line.find(mark); at != std::string::npos) {
      out.push_back(line.substr(at + mark.size()));
    }
  }
  return out;
}

Result<void> ServerProcess::wait_ready(const std::string& scene) {
  for (int waited = 0; waited < kServerPatienceMs; waited += 20) {
    const std::string port = read_file(folder_ + "/port");
    if (!port.empty() && port.back() == '\n') {  // the whole line
      port_ = std::atoi(port.c_str());
      return {};
    }
    int status = 0;
    if (waitpid(pid_, &status, WNOHANG) == pid_) {
      pid_ = -1;
      const std::optional<Error> said = error_said(read_file(folder_ + "/err"));
      if (said) return *said;
      return make_error(ErrorId::kInternal, "mirage-server " + scene + " ended with exit code " +
                                                std::to_string(status_to_code(status)));
    }
    std::this_thread::sleep_for(std::chrono::milliseconds(20));
  }
  return make_error(ErrorId::kNetworkTimeout, "mirage-server " + scene + " does not get ready");
}

void ServerProcess::end() {
  kill(pid_, SIGTERM);
  int status = 0;
  for (int waited = 0; waited < kStopPatienceMs; waited += 20) {
    if (waitpid(pid_, &status, WNOHANG) == pid_) return;
    std::this_thread::sleep_for(std::chrono::milliseconds(20));
  }
  kill(pid_, SIGKILL);
  waitpid(pid_, &status, 0);
}

ServerProcess::~ServerProcess() {
  if (pid_ > 0) end();
  std::error_code ignored;
  if (!folder_.empty()) fs::remove_all(folder_, ignored);
}

}  // namespace mirage
