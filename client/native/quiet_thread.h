#pragma once

#include <functional>
#include <thread>

namespace mirage {

/// Starts a thread with a name of at most 15 characters that takes no signals: they are for the
/// program that this library is a part of.
std::thread quiet_thread(const char* name, std::function<void()> run);

}  // namespace mirage
