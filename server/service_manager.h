#pragma once
// Messages to a service manager that started the program with NOTIFY_SOCKET: systemd's protocol for
// Type=notify and WatchdogSec= (sd_notify(3)), one datagram a line.
// Thread: any; never waits.

#include <string>

namespace mirage {

class ServiceManager {
 public:
  /// Takes NOTIFY_SOCKET from the environment. Without it, nothing is sent.
  ServiceManager();
  ~ServiceManager();
  ServiceManager(const ServiceManager&) = delete;
  ServiceManager& operator=(const ServiceManager&) = delete;

  void ready(const std::string& status) const { tell("READY=1\nSTATUS=" + status); }
  void reloading() const;
  void stopping() const { tell("STOPPING=1"); }
  /// Feeds the watchdog; to be called more often than WatchdogSec=.
  void alive() const { tell("WATCHDOG=1"); }

 private:
  void tell(const std::string& lines) const;

  std::string address_;  ///< of the socket; a leading 0 byte: an abstract socket
  int socket_ = -1;
};

}  // namespace mirage
