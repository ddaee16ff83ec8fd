#include "client/host/stop_signal.h"

#include <csignal>
#include <cstdlib>
#include <thread>
#include <utility>

namespace mirage {

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
      sigwait(&signals, &which);
    }
    std::_Exit(128 + which);
  }).detach();
}

}  // namespace mirage
