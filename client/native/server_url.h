#pragma once
// Where a server is, as its ready line prints it.

#include <string>

#include "protocol/base/result.h"

namespace mirage {

struct ServerUrl {
  std::string host;  ///< a name or an address; of a unix socket its path
  int port = 9870;
  bool tls = false;
  bool unix_socket = false;

  /// As libwebsockets connects to it.
  std::string address() const { return unix_socket ? "+" + host : host; }
  /// For the Host header.
  std::string host_header() const;
};

/// ws://HOST[:PORT], ws://[IPv6][:PORT], wss://… or unix:PATH; error kUsage.
Result<ServerUrl> parse_url(const std::string& url);

}  // namespace mirage
