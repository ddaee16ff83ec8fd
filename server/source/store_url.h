#pragma once
// The address of a store that servers share.

#include <cstdint>
#include <string>

#include "protocol/base/result.h"

namespace mirage {

/// Address of a Redis server.
struct StoreAddress {
  std::string host;
  int port = 6379;
  std::string password;  ///< empty: none
  int database = 0;

  /// Returns the address for messages, without the password.
  std::string name() const { return host + ":" + std::to_string(port); }
};

/// Parses `redis://[:PASSWORD@]HOST[:PORT][/DATABASE]`. Error kUsage.
Result<StoreAddress> parse_store_url(const std::string& url);

}  // namespace mirage
