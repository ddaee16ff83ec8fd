#include "tests/support/process.h"

#include <fcntl.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <csignal>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <thread>

#include "tests/support/data_folder.h"

namespace mirage::test {
namespace {

namespace fs = std::filesystem;
using Clock = std::chrono::steady_clock;

double seconds_since(Clock::time_point start) {
  return std::chrono::duration<double>(Clock::now() - start).count();
}

int spawn(const std::vector<std::string>& command, const std::string& log) {
  std::vector<char*> arguments;
  for (const std::string& a : command) arguments.push_back(const_cast<char*>(a.c_str()));
  arguments.push_back(nullptr);
  const int pid = fork();
  if (pid != 0) return pid;
  const int file = open(log.c_str(), O_WRONLY | O_CREAT | O_TRUNC, 0644);
  dup2(file, 1);
  dup2(file, 2);
  execv(arguments[0], arguments.data());
  _exit(127);
}

int exit_code(int status) {
  return WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
}

// Waits for the process. Returns its status; -1: it was still running at the end, and was killed.
int wait_for(int pid, double timeout_s, rusage* used = nullptr) {
  const Clock::time_point start = Clock::now();
  int status = 0;
  while (seconds_since(start) < timeout_s) {
    if (wait4(pid, &status, WNOHANG, used) == pid) return exit_code(status);
    std::this_thread::sleep_for(std::chrono::milliseconds(5));
  }
  kill(pid, SIGKILL);
  waitpid(pid, &status, 0);
  return -1;
}

}  // namespace

std::string binary(const std::string& name) {
  return (fs::read_symlink("/proc/self/exe").parent_path() / name).string();
}

std::string read_file(const std::string& path) {
  std::ifstream file(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(file), std::istreambuf_iterator<char>()};
}

std::string shared_folder() { return data_folder().string(); }

std::string scratch_folder() {
  struct Folder {
    std::string path;
    Folder() {
      std::string pattern = (fs::temp_directory_path() / "mirage-test-XXXXXX").string();
      path = mkdtemp(pattern.data());
    }
    ~Folder() {
      std::error_code ignored;
      fs::remove_all(path, ignored);
    }
  };
  static const Folder folder;
  static int count = 0;
  const std::string one = folder.path + "/" + std::to_string(count++);
  fs::create_directories(one);
  return one;
}

Finished run(const std::vector<std::string>& command, double timeout_s) {
  const std::string log = scratch_folder() + "/log";
  const Clock::time_point start = Clock::now();
  Finished out;
  rusage used{};
  out.exit_code = wait_for(spawn(command, log), timeout_s, &used);
  out.peak_mb = static_cast<double>(used.ru_maxrss) / 1024;
  out.seconds = seconds_since(start);
  out.output = read_file(log);
  return out;
}

// Returns the URL of the ready line; empty: it is not ready yet.
std::string ready_url(const std::string& log) {
  const std::string before = "ready url=";
  const std::size_t at = log.find(before), end = log.find('\n', at);
  if (at == std::string::npos || end == std::string::npos) return "";
  return log.substr(at + before.size(), log.find(' ', at + before.size()) - at - before.size());
}

Server::Server(const std::string& scene, const std::vector<std::string>& extra,
               const std::vector<std::string>& environment)
    : folder_(scratch_folder()) {
  std::vector<std::string> command = {"/usr/bin/env"};
  command.insert(command.end(), environment.begin(), environment.end());
  command.insert(command.end(), {binary("mirage-server"), scene, "--listen", "127.0.0.1:0"});
  command.insert(command.end(), extra.begin(), extra.end());
  const bool has_port = std::none_of(extra.begin(), extra.end(), [](const std::string& word) {
    return word.rfind("unix:", 0) == 0;
  });
  if (has_port) command.insert(command.end(), {"--port-file", folder_ + "/port"});
  pid_ = spawn(command, folder_ + "/log");
  const Clock::time_point start = Clock::now();
  while (seconds_since(start) < 60) {
    const std::string url = ready_url(log());
    if (!url.empty()) {
      if (has_port) port_ = std::atoi(read_file(folder_ + "/port").c_str());
      url_ = url;
      return;
    }
    int status = 0;
    if (waitpid(pid_, &status, WNOHANG) == pid_) {
      pid_ = -1;
      return;
    }
    std::this_thread::sleep_for(std::chrono::milliseconds(10));
  }
}

Server::~Server() { stop(SIGTERM); }

int Server::stop(int signal) {
  if (pid_ < 0) return -1;
  kill(pid_, signal);
  const int code = wait_for(pid_, 20);
  pid_ = -1;
  return code;
}

int Server::wait(double timeout_s) {
  if (pid_ < 0) return -1;
  const int code = wait_for(pid_, timeout_s);
  pid_ = -1;
  return code;
}

std::string Server::log() const { return read_file(folder_ + "/log"); }

}  // namespace mirage::test
