#pragma once
// Server URL: the address of a server, as its ready line prints it.

#include <string>

#include "protocol/base/result.h"
#include "protocol/model/scene_types.h"

namespace mirage {

struct ServerUrl {
  std::string host;  ///< name or address; for a unix socket its path
  int port = 9870;
  bool tls = false;
  bool unix_socket = false;
  std::string path = "/";
  std::string ca_file = {};  ///< certificates to trust beside those of the system, PEM; empty: none
  SceneChoice choice = {};   ///< from ?clip=NAME&variant=NAME

  /// Returns the address in the form that libwebsockets takes.
  std::string address() const { return unix_socket ? "+" + host : host; }
  /// Returns the value of the Host header.
  std::string host_header() const;
};

/// Parses ws://HOST[:PORT][/PATH/], ws://[IPv6]…, wss://…, an address as a browser shows it
/// (http://… or https://…; port 80 or 443 if it has none), or unix:PATH; error kUsage. Of what
/// follows a '?', the choice is read, with percent-encoded bytes; the rest, and what follows a '#',
/// is left out.
Result<ServerUrl> parse_url(const std::string& url);

}  // namespace mirage
