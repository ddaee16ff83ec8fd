#include "client/host/server_process.h"

#include <chrono>
#include <cstdlib>
#include <sstream>
#include <thread>

#include "protocol/base/clock.h"

namespace mirage {
namespace {

// A large scene's levels of detail take minutes.
constexpr std::chrono::milliseconds kServerPatience{300'000}, kPause{20};

}  // namespace

Result<std::unique_ptr<ServerProcess>> ServerProcess::start(const std::string& scene,
                                                            const std::string& device,
                                                            const std::vector<std::string>& more) {
  const std::optional<std::string> program = sibling_program("mirage-server");
  if (!program) {
    return make_error(ErrorId::kIo, "there is no mirage-server beside this program",
                      "build it, or give the address of one: --url ws://HOST:PORT");
  }
  Result<ScratchFolder> folder = ScratchFolder::make();
  if (!folder) return folder.error();
  std::unique_ptr<ServerProcess> server(new ServerProcess);
  server->folder_.emplace(folder.take());
  std::vector<std::string> command = {*program,      scene,         "--listen",
                                      "127.0.0.1:0", "--port-file", server->file("port"),
                                      "--device",    device};
  command.insert(command.end(), more.begin(), more.end());
  const SteadyClock clock;
  const Result<int> pid = start_child(command, server->file("out"), server->file("err"));
  if (!pid) return pid.error();
  server->pid_ = *pid;
  if (Result<void> ready = server->wait_ready(scene); !ready) return ready.error();
  server->ready_s_ = static_cast<double>(clock.now_us()) * 1e-6;
  return server;
}

std::optional<double> ServerProcess::peak_mb() const {
  std::istringstream status(read_whole_file("/proc/" + std::to_string(pid_) + "/status"));
  std::string line;
  while (std::getline(status, line)) {
    if (line.rfind("VmHWM:", 0) == 0) return std::atof(line.c_str() + 6) * 1024 * 1e-6;
  }
  return std::nullopt;
}

std::string ServerProcess::ready_value(const std::string& key) const {
  std::istringstream words(read_whole_file(file("out")));
  std::string word;
  while (words >> word) {
    if (word.rfind(key + "=", 0) == 0) return word.substr(key.size() + 1);
  }
  return "";
}

std::vector<std::string> ServerProcess::scene_warnings() const {
  const std::string mark = "warning scene: ";
  std::istringstream lines(read_whole_file(file("err")));
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
  for (auto waited = kPause; waited < kServerPatience; waited += kPause) {
    const std::string port = read_whole_file(file("port"));
    if (!port.empty() && port.back() == '\n') {  // the whole line
      port_ = std::atoi(port.c_str());
      return {};
    }
    if (const std::optional<int> code = ended_child(pid_)) {
      pid_ = -1;
      const std::optional<Error> said = error_said(read_whole_file(file("err")));
      if (said) return *said;
      return make_error(ErrorId::kInternal, "mirage-server " + scene + " ended with exit code " +
                                                std::to_string(*code));
    }
    std::this_thread::sleep_for(kPause);
  }
  return make_error(ErrorId::kNetworkTimeout, "mirage-server " + scene + " does not get ready");
}

std::string ServerProcess::file(const std::string& name) const {
  return folder_->path() + "/" + name;
}

ServerProcess::~ServerProcess() {
  if (pid_ > 0) end_child(pid_);
}

}  // namespace mirage
