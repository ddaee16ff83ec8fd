#include "protocol/base/resources.h"

#include <sys/resource.h>
#include <unistd.h>

#include <algorithm>
#include <fstream>
#include <future>
#include <new>
#include <sstream>
#include <system_error>
#include <thread>
#include <vector>

#include "protocol/base/fail.h"

namespace mirage {
namespace {

std::string first_line(const char* path) {
  std::ifstream in(path);
  std::string line;
  std::getline(in, line);
  return line;
}

/// Returns a limit as text; empty: there is none.
std::string limit_text(decltype(RLIMIT_AS) which, rlim_t unit) {
  rlimit limit{};
  if (getrlimit(which, &limit) != 0 || limit.rlim_cur == RLIM_INFINITY) return "";
  return std::to_string(limit.rlim_cur / unit);
}

/// Returns what limits threads: processes and threads of this user, and those of the container.
std::string thread_limits() {
  const std::string user = limit_text(RLIMIT_NPROC, 1);
  const std::string container = first_line("/sys/fs/cgroup/pids.max");
  std::string out = user.empty() ? "" : "ulimit -u is " + user;
  if (!container.empty() && container != "max") {
    out += (out.empty() ? "" : ", ") + ("the container's limit of processes is " + container);
  }
  const std::string memory = limit_text(RLIMIT_AS, 1024);
  if (!memory.empty()) out += (out.empty() ? "" : ", ") + ("ulimit -v is " + memory + " KB");
  return out.empty() ? "" : ": " + out;
}

std::string memory_limits() {
  const std::string space = limit_text(RLIMIT_AS, 1024);
  const std::string container = first_line("/sys/fs/cgroup/memory.max");
  std::string out = space.empty() ? "" : "ulimit -v is " + space + " KB";
  if (!container.empty() && container != "max") {
    out += (out.empty() ? "" : ", ") + ("the container's limit is " + container + " bytes");
  }
  return out.empty() ? "" : ": " + out;
}

}  // namespace

Result<void> require_threads(unsigned count) {
  std::promise<void> end;
  const std::shared_future<void> ended = end.get_future().share();
  std::vector<std::thread> threads;
  bool all = true;
  try {
    while (threads.size() < count) threads.emplace_back([ended] { ended.wait(); });
  } catch (const std::exception&) {
    all = false;
  }
  const std::size_t started = threads.size();
  end.set_value();
  for (std::thread& thread : threads) thread.join();
  if (all) return {};
  return make_error(ErrorId::kResources,
                    "only " + std::to_string(started) + " threads can be started, " +
                        std::to_string(count) + " are needed" + thread_limits(),
                    "raise ulimit -u, or the container's --pids-limit");
}

Result<void> require_threads() {
  return require_threads(kFewestThreads + std::thread::hardware_concurrency());
}

Result<void> require_addresses(unsigned megabytes) {
  rlimit limit{};
  const rlim_t least = rlim_t{megabytes} << 20;
  if (getrlimit(RLIMIT_AS, &limit) != 0 || limit.rlim_cur >= least) return {};
  return make_error(
      ErrorId::kResources,
      "at least " + std::to_string(megabytes) + " MB of addresses are needed" + memory_limits(),
      "raise ulimit -v, or lift it");
}

std::uint64_t memory_bytes() {
  std::uint64_t bytes = static_cast<std::uint64_t>(sysconf(_SC_PHYS_PAGES)) *
                        static_cast<std::uint64_t>(sysconf(_SC_PAGESIZE));
  std::uint64_t container = 0;
  std::istringstream line(first_line("/sys/fs/cgroup/memory.max"));
  if (line >> container) bytes = std::min(bytes, container);
  rlimit limit{};
  if (getrlimit(RLIMIT_AS, &limit) == 0) bytes = std::min<std::uint64_t>(bytes, limit.rlim_cur);
  return std::max<std::uint64_t>(bytes, 1 << 20);
}

int run_program(const std::function<int()>& main_part) {
  try {
    return main_part();
  } catch (const std::exception& exception) {
    return fail(error_of(exception));
  }
}

Error error_of(const std::exception& exception) {
  if (dynamic_cast<const std::bad_alloc*>(&exception) != nullptr) {
    return make_error(ErrorId::kResources, "memory ran out" + memory_limits(),
                      "give it more memory, or lower --cache-mb and --gpu-mb");
  }
  const auto* failed = dynamic_cast<const std::system_error*>(&exception);
  if (failed != nullptr && failed->code() == std::errc::resource_unavailable_try_again) {
    return make_error(ErrorId::kResources, "no more threads can be started" + thread_limits(),
                      "raise ulimit -u, or the container's --pids-limit");
  }
  return make_error(ErrorId::kInternal, exception.what());
}

}  // namespace mirage
