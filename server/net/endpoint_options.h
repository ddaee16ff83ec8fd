#pragma once

#include <optional>
#include <string>

#include "server/net/listen_address.h"

namespace mirage {

struct EndpointOptions {
  ListenAddress address;
  std::string tls_cert;  ///< PEM files; both or none
  std::string tls_key;
  /// The only Origin a browser may come from beside this server's own.
  std::string allow_origin;
  double drain_s = 10;   ///< for which what was asked for is still served once told to stop
  std::string web;       ///< folder of the page for browsers; empty: none
  bool metrics = false;  ///< GET /metrics
  /// A second one, for who operates the server: health and metrics only. nullopt: none.
  std::optional<ListenAddress> admin;
};

}  // namespace mirage
