#include "tests/extreme/child_run.h"

#include <fcntl.h>
#include <poll.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cerrno>
#include <chrono>
#include <csignal>
#include <cstdio>
#include <cstring>
#include <exception>
#include <filesystem>
#include <nlohmann/json.hpp>

namespace mirage::extreme {
namespace {

using SteadyTime = std::chrono::steady_clock;
using nlohmann::json;

#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
constexpr bool kSanitized = true;  // shadow memory reserves terabytes of addresses
#else
constexpr bool kSanitized = false;
#endif
constexpr double kSanitizerSlowdown = 10;
constexpr int kResultFile = 3;  // where a child writes

double seconds_since(SteadyTime::time_point start) {
  return std::chrono::duration<double>(SteadyTime::now() - start).count();
}

json value_json(const Value& v) {
  if (const double* number = std::get_if<double>(&v)) {
    // JSON has no infinities, so they become words.
    return *number - *number == 0 ? json(*number) : json(number_text(*number));
  }
  return std::get<std::string>(v);
}

Value value_of(const json& v) {
  if (v.is_number()) return v.get<double>();
  return v.get<std::string>();
}

Outcome failure(const std::string& what) { return {what, std::string("a result"), false}; }

void write_all(int file, const std::string& text) {
  for (std::size_t done = 0; done < text.size();) {
    const ssize_t n = ::write(file, text.data() + done, text.size() - done);
    if (n < 0 && errno != EINTR) return;
    if (n > 0) done += static_cast<std::size_t>(n);
  }
}

// Starts this program again for one case, because a fork would lose the threads of libraries.
[[noreturn]] void start_child(const Case& one, const Conditions& conditions, int out) {
  setpgid(0, 0);
  dup2(out, kResultFile);
  if (!kSanitized) {
    const rlim_t bytes = static_cast<rlim_t>(one.memory_mb) << 20;
    const rlimit limit{bytes, bytes};
    setrlimit(RLIMIT_AS, &limit);
  }
  const char* form = conditions.quick ? "--quick" : nullptr;
  execl("/proc/self/exe", "mirage-extreme", "--child", one.id, "--folder",
        conditions.folder.c_str(), "--data", conditions.data.c_str(), form, nullptr);
  _exit(127);
}

// Reads all that the child writes; false if it is still writing at the end of its time.
bool read_until(int in, SteadyTime::time_point start, double limit_s, std::string& text) {
  char buffer[4096];
  while (true) {
    const double left = limit_s - seconds_since(start);
    if (left <= 0) return false;
    pollfd ready{in, POLLIN, 0};
    if (poll(&ready, 1, static_cast<int>(left * 1000) + 1) <= 0) continue;
    const ssize_t n = read(in, buffer, sizeof buffer);
    if (n < 0 && errno == EINTR) continue;
    if (n <= 0) return true;
    text.append(buffer, static_cast<std::size_t>(n));
  }
}

Outcome read_outcome(const std::string& text, int status) {
  if (WIFSIGNALED(status)) {
    const int signal = WTERMSIG(status);
    return failure("crashed: signal " + std::to_string(signal) + " (" + strsignal(signal) + ")");
  }
  if (WEXITSTATUS(status) != 0) {
    return failure("exit code " + std::to_string(WEXITSTATUS(status)) + ", see its output");
  }
  const json row = json::parse(text, nullptr, false);
  if (row.is_discarded()) return failure("no result was written");
  return {value_of(row["measured"]), value_of(row["limit"]), row["pass"].get<bool>()};
}

}  // namespace

void run_as_child(const Case& one, const Conditions& conditions) {
  Outcome outcome;
  try {
    outcome = one.run(conditions);
  } catch (const std::exception& e) {
    outcome = failure(std::string("exception: ") + e.what());
  }
  const json row = {{"measured", value_json(outcome.measured)},
                    {"limit", value_json(outcome.limit)},
                    {"pass", outcome.pass}};
  write_all(kResultFile, row.dump(-1, ' ', false, json::error_handler_t::replace));
}

ChildRun run_in_child(const Case& one, const Conditions& conditions) {
  ChildRun out;
  int ends[2];
  if (pipe2(ends, O_CLOEXEC) != 0) {
    out.outcome = failure("no pipe");
    return out;
  }
  std::fflush(nullptr);
  const auto start = SteadyTime::now();
  Conditions own = conditions;
  own.folder += std::string("/") + one.id;
  std::filesystem::create_directories(own.folder);
  const pid_t pid = fork();
  if (pid < 0) {
    out.outcome = failure("no process");
    return out;
  }
  if (pid == 0) {
    start_child(one, own, ends[1]);
  }
  setpgid(pid, pid);
  close(ends[1]);
  const double limit_s = one.time_s * (kSanitized ? kSanitizerSlowdown : 1);
  std::string text;
  const bool in_time = read_until(ends[0], start, limit_s, text);
  close(ends[0]);
  int status = 0;
  rusage usage{};
  bool ended = false;
  while (in_time && !ended && seconds_since(start) < limit_s) {
    ended = wait4(pid, &status, WNOHANG, &usage) == pid;
    if (!ended) usleep(2000);
  }
  if (!ended) {
    kill(-pid, SIGKILL);
    wait4(pid, &status, 0, &usage);
  }
  kill(-pid, SIGKILL);  // ends what a crashed case left behind
  out.seconds = seconds_since(start);
  out.peak_mb = usage.ru_maxrss / 1024;
  out.outcome = ended ? read_outcome(text, status)
                      : failure("still running after " + number_text(limit_s) + " s");
  return out;
}

}  // namespace mirage::extreme
