#pragma once

#include <string>

#include "server/net/listen_address.h"

namespace mirage {

struct EndpointOptions {
  ListenAddress address;
  std::string tls_cert;  ///< PEM files; both or none
  std::string tls_key;
  std::string allow_origin;  ///< empty: any; else the only Origin a browser may come from
  bool metrics = false;      ///< GET /metrics
};

}  // namespace mirage
