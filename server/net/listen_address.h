#pragma once
// The address a server listens at.

#include <string>
#include <vector>

#include "protocol/base/result.h"

namespace mirage {

struct ListenAddress {
  std::string host = "127.0.0.1";  ///< a name or an address; IPv6 without brackets
  int port = 9870;                 ///< 0: any free port
  std::string socket_path;         ///< if not empty, a unix socket is used instead

  /// Returns `ws://HOST:PORT` with the port in use, or `unix:PATH`, in the form that clients
  /// accept.
  std::string url(bool tls, int taken_port) const;
};

/// Returns the addresses at which a browser finds the page: for 0.0.0.0 and [::] those of this
/// machine's interfaces, at most eight, IPv4 first. None for a unix socket.
std::vector<std::string> page_urls(const ListenAddress& address, bool tls, int taken_port);

/// Parses HOST:PORT, [IPv6]:PORT or unix:PATH. Error kUsage.
Result<ListenAddress> parse_listen(const std::string& text);

/// Returns the numeric address of a host's name, IPv4 before IPv6; a numeric address is returned as
/// it is. Error kNetworkListen: the name is unknown.
Result<std::string> numeric_address(const std::string& host);

/// True if only this machine can reach the address.
bool is_loopback(const ListenAddress& address);

/// Frees the path for a socket by removing the socket of a server that is gone. Error
/// kNetworkListen: a server answers there, or the path is not a socket.
Result<void> free_socket_path(const std::string& path);

}  // namespace mirage
