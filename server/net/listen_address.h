#pragma once
// Where a server listens.

#include <string>

#include "protocol/base/result.h"

namespace mirage {

struct ListenAddress {
  std::string host = "127.0.0.1";  ///< a name or an address; IPv6 without brackets
  int port = 9870;                 ///< 0: any free port
  std::string socket_path;         ///< not empty: a unix socket instead

  /// `ws://HOST:PORT` with the port that was taken, or `unix:PATH`, as clients take it.
  std::string url(bool tls, int taken_port) const;
};

/// HOST:PORT, [IPv6]:PORT or unix:PATH; error kUsage.
Result<ListenAddress> parse_listen(const std::string& text);

/// The numeric address of a host's name, IPv4 before IPv6; what is numeric stays as it is. Error
/// kNetworkListen when nobody knows the name.
Result<std::string> numeric_address(const std::string& host);

/// Only this machine reaches it.
bool is_loopback(const ListenAddress& address);

/// Makes the path free for a socket: the socket of a server that is gone is removed. Errors
/// kNetworkListen: a server answers there, or the path is something else than a socket.
Result<void> free_socket_path(const std::string& path);

}  // namespace mirage
