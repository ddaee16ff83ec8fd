#pragma once

#include <optional>
#include <string>
#include <vector>

#include "server/download/download_request.h"
#include "server/net/forwarded.h"
#include "server/net/listen_address.h"

namespace mirage {

struct EndpointOptions {
  ListenAddress address;
  std::string tls_cert;  ///< PEM files; both or none
  std::string tls_key;
  /// Origins that browsers may come from, besides this server's own.
  std::vector<std::string> allow_origins;
  /// Origins of pages that may show the browser page in a frame, besides this server's own.
  std::vector<std::string> embed_origins;
  TrustedProxies proxies;
  double drain_s = 10;   ///< seconds in which earlier asks are still served after stop()
  std::string web;       ///< folder of the browser page; empty: none
  bool metrics = false;  ///< serves GET /metrics
  std::optional<DownloadScene> downloads;  ///< what they are made of; nullopt: there are none
  /// A second address for operators, with health and metrics only; nullopt: none.
  std::optional<ListenAddress> admin;
};

}  // namespace mirage
