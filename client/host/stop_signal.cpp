#include "client/host/stop_signal.h"

#include <chrono>
#include <csignal>
#include <cstdlib>
#include <thread>
#include <utility>

namespace mirage {

namespace {
constexpr std::chrono::seconds kSameSignal{1};
}

StopSignal::StopSignal(std::function<void()> stopped) {
  sigset_t signals;
  sigemptyset(&signals);
  sigaddset(&signals, SIGINT);
  sigaddset(&signals, SIGTERM);
  pthread_sigmask(SIG_BLOCK, &signals, nullptr);
  std::thread([signals, state = state_, stopped = std::move(stopped)] {
    int which = 0;
    sigwait(&signals, &which);
    if (state->frames) {
      state->stopped = true;
      if (stopped) stopped();
      // timeout(1) sends each signal twice, to the program and to its group.
      std::this_thread::sleep_for(kSameSignal);
      const timespec at_once{};
      while (sigtimedwait(&signals, nullptr, &at_once) > 0) continue;
      sigwait(&signals, &which);
    }
    std::_Exit(128 + which);
  }).detach();
}

}  // namespace mirage
