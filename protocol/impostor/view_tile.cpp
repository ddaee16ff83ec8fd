#include "protocol/impostor/view_tile.h"

#include <xxhash.h>

#include <algorithm>
#include <cmath>
#include <cstring>

namespace mirage {
namespace {

constexpr double kCodes = 255;

}  // namespace

std::uint8_t ViewTile::encode_depth(double depth_m) const {
  const double range = std::log(far_m / near_m);
  if (!(range > 0)) return 255;
  const double share = std::log(far_m / depth_m) / range;
  return static_cast<std::uint8_t>(1 + std::clamp(std::floor(share * kCodes), 0.0, kCodes - 1));
}

double ViewTile::decode_depth(std::uint8_t code) const {
  return far_m * std::pow(near_m / far_m, code / kCodes);
}

double ViewTile::depth_step() const { return 1 - std::pow(near_m / far_m, 1 / kCodes); }

TileId view_id(std::uint64_t revision, std::uint64_t lighting_hash, const ViewPose& pose) {
  const Camera& c = pose.camera;
  const double key[] = {c.pose.eye.x,
                        c.pose.eye.y,
                        c.pose.eye.z,
                        double{c.pose.rotation.w},
                        double{c.pose.rotation.x},
                        double{c.pose.rotation.y},
                        double{c.pose.rotation.z},
                        c.fov_y,
                        static_cast<double>(c.width),
                        static_cast<double>(c.height),
                        pose.time_s};
  const std::uint64_t head[] = {revision, lighting_hash};
  std::uint8_t bytes[sizeof(head) + sizeof(key)];
  std::memcpy(bytes, head, sizeof(head));
  std::memcpy(bytes + sizeof(head), key, sizeof(key));
  const XXH128_hash_t hash = XXH3_128bits(bytes, sizeof(bytes));
  return {hash.low64, hash.high64};
}

}  // namespace mirage
