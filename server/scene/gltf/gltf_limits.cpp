#include "server/scene/gltf/gltf_limits.h"

#include <algorithm>
#include <limits>
#include <string>

namespace mirage::gltf {
namespace {

/// The budget at which the counts below are given; others follow in proportion.
constexpr std::uint64_t kMegabytes = 3072;

/// Indices and vertices are counted in 32 bits, and tinygltf's text in an `unsigned int`.
constexpr std::uint64_t kMost = std::numeric_limits<std::uint32_t>::max() / 2;

Error budget_error(const SceneLimits& limits, const std::string& count, std::uint64_t limit,
                   std::string_view what, const std::string& larger, std::string_view helps) {
  return make_error(ErrorId::kSceneLimit,
                    count + " " + std::string(what) + ", a scene of " +
                        std::to_string(limits.megabytes) + " MB may have " + std::to_string(limit),
                    (limit < kMost ? larger + "; or " : "") +
                        "make fewer of them: npx @gltf-transform/cli " + std::string(helps));
}

}  // namespace

Error SceneLimits::exceeded(std::uint64_t count, std::uint64_t limit, std::string_view what,
                            std::string_view helps) const {
  const double needed = static_cast<double>(count) / static_cast<double>(limit);
  const auto enough = static_cast<std::uint64_t>(static_cast<double>(megabytes) * needed) + 1;
  return budget_error(*this, std::to_string(count), limit, what,
                      "--scene-mb " + std::to_string(enough) + " has room for so many", helps);
}

Error SceneLimits::exceeded_at_least(std::uint64_t count, std::uint64_t limit,
                                     std::string_view what, std::string_view helps) const {
  return budget_error(*this, "at least " + std::to_string(count), limit, what,
                      "--scene-mb " + std::to_string(2 * megabytes) + " has room for twice as many",
                      helps);
}

SceneLimits limits_within(std::uint64_t megabytes) {
  const auto share = [&](std::uint64_t count) {
    const double part = static_cast<double>(megabytes) / static_cast<double>(kMegabytes);
    return std::clamp<std::uint64_t>(static_cast<std::uint64_t>(static_cast<double>(count) * part),
                                     1, kMost);
  };
  SceneLimits limits;
  limits.megabytes = megabytes;
  limits.file_bytes = megabytes * ((1 << 20) / 6);
  limits.json_bytes = share(512ull << 20);
  limits.json_values = share(18'000'000);
  limits.elements = share(2'000'000);
  limits.primitives = share(400'000);
  limits.vertices = share(8'500'000);
  limits.indices = share(60'000'000);
  limits.draco_faces = share(6'600'000);
  limits.draco_faces_in_file = share(12'000'000);
  limits.draco_bytes = share(256ull << 20);
  limits.decoded_pixels = share(512ull << 20);
  limits.whole_pixels = share(192ull << 20);
  return limits;
}

}  // namespace mirage::gltf
