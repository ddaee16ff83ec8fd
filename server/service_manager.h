#pragma once
// What a service manager is told, where one started the program with NOTIFY_SOCKET: systemd's
// protocol for Type=notify and WatchdogSec= (sd_notify(3)), a datagram a line.
// Thread: any; never waits.

#include <string>

namespace mirage {

class ServiceManager {
 public:
  /// Takes NOTIFY_SOCKET from the environment. Without it nothing is told.
  ServiceManager();
  ~ServiceManager();
  ServiceManager(const ServiceManager&) = delete;
  ServiceManager& operator=(const ServiceManager&) = delete;

  void ready(const std::string& status) const { tell("READY=1\nSTATUS=" + status); }
  void reloading() const;
  void stopping() const { tell("STOPPING=1"); }
  /// Before WatchdogSec= is over, again and again.
  void alive() const { tell("WATCHDOG=1"); }

 private:
  void tell(const std::string& lines) const;

  std::string address_;  ///< of the socket; a 0 first: an abstract one
  int socket_ = -1;
};

}  // namespace mirage
