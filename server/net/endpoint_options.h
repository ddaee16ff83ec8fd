#pragma once

#include <optional>
#include <string>

#include "server/net/listen_address.h"

namespace mirage {

struct EndpointOptions {
  ListenAddress address;
  std::string tls_cert;  ///< PEM files; both or none
  std::string tls_key;
  /// An additional Origin that browsers may come from, besides this server's own.
  std::string allow_origin;
  double drain_s = 10;   ///< seconds in which earlier asks are still served after stop()
  std::string web;       ///< folder of the browser page; empty: none
  bool metrics = false;  ///< serves GET /metrics
  /// A second address for operators, with health and metrics only; nullopt: none.
  std::optional<ListenAddress> admin;
};

}  // namespace mirage
