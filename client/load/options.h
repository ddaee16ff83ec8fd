#pragma once
#include <cstdint>
#include <optional>
#include <string>

#include "client/native/native_link.h"
#include "protocol/base/shard.h"

namespace mirage {

struct LoadOptions {
  ServerUrl url;
  std::string url_text;
  std::uint32_t clients = 10;
  double duration_s = 10;
  double rate_hz = 10;  ///< tiles asked for, per client and second
  std::string path = "builtin:walk";
  double spread_s = 60;  ///< clients start within this stretch of the path
  double fps = 30;       ///< steps of a client's camera per second
  std::uint32_t width = 640, height = 360;
  double fov_degrees = 60;
  double tau_px = 1;
  double verify_share = 0.1;
  std::uint64_t seed = 1;
  bool warm = false;
  bool reconnect = false;
  std::optional<Shard> warm_shard;  ///< the run asks once for each of its tiles, and ends
  std::string urls_file;
  double connects_per_s = 200;
  double connect_timeout_s = 10;
  std::string json_file;
  std::string token;
};

/// Reads the command line. Returns an exit code if the program should end at once, otherwise -1.
int parse_options(int argc, char** argv, LoadOptions& options);

}  // namespace mirage
