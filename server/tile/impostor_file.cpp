#include "server/tile/impostor_file.h"

#include <algorithm>
#include <cstring>
#include <string_view>

#include "protocol/codec/image_codec.h"

namespace mirage {
namespace {

// Share of the cells that may be nearer than `near`: a leaf before the eye would take the steps of
// all that is behind it.
constexpr double kNearerShare = 0.01;

constexpr std::size_t kRiffBytes = 12, kChunkBytes = 8, kExtendedBytes = 10;

template <typename T>
void put(Bytes& out, const T& value) {
  const auto* bytes = reinterpret_cast<const std::uint8_t*>(&value);
  out.insert(out.end(), bytes, bytes + sizeof(value));
}

void put(Bytes& out, std::string_view text) { out.insert(out.end(), text.begin(), text.end()); }

std::uint32_t cells(std::uint32_t px) {
  return (px + kImpostorCellTexels - 1) / kImpostorCellTexels;
}

/// Returns the inverse eye depth of each cell's nearest surface, 1/m; 0: sky.
std::vector<double> nearness(const Camera& camera, const std::vector<float>& depth) {
  std::vector<double> out(std::size_t{cells(camera.width)} * cells(camera.height));
  for (std::uint32_t y = 0; y < camera.height; ++y) {
    for (std::uint32_t x = 0; x < camera.width; ++x) {
      const float z = depth[std::size_t{y} * camera.width + x];
      const std::size_t at =
          std::size_t{y / kImpostorCellTexels} * cells(camera.width) + x / kImpostorCellTexels;
      if (z > 0) out[at] = std::max(out[at], 1.0 / z);
    }
  }
  return out;
}

/// Least and greatest inverse depth that texels tell, 1/m.
struct Span {
  double far = 1, near = 1;
};

Span span_of(std::vector<double> nearness) {
  nearness.erase(std::remove(nearness.begin(), nearness.end(), 0.0), nearness.end());
  if (nearness.empty()) return {};
  std::sort(nearness.begin(), nearness.end());
  const auto nearer = static_cast<std::size_t>(kNearerShare * static_cast<double>(nearness.size()));
  return {nearness.front(), nearness[nearness.size() - 1 - nearer]};
}

Image texels_of(const std::vector<double>& nearness, const Span& span, const Camera& camera) {
  Image out{cells(camera.width), cells(camera.height), false, {}};
  out.rgba.reserve(4 * nearness.size());
  for (const double one : nearness) {
    const double share = span.near > span.far ? (one - span.far) / (span.near - span.far) : 0;
    const auto texel = static_cast<std::uint8_t>(std::clamp(share, 0.0, 1.0) * 255 + 0.5);
    out.rgba.insert(out.rgba.end(), {texel, texel, texel, 255});
  }
  return out;
}

}  // namespace

Result<Bytes> impostor_chunk(const Camera& camera, const SceneFrame& frame) {
  const std::vector<double> near = nearness(camera, frame.depth);
  const Span span = span_of(near);
  const Result<Bytes> depth = encode_image(texels_of(near, span, camera));
  if (!depth) return depth.error();
  Bytes content;
  put(content, kImpostorVersion);
  put(content, static_cast<float>(camera.fov_y));
  put(content, static_cast<float>(1 / span.near));
  put(content, static_cast<float>(1 / span.far));
  const glm::quat& q = camera.pose.rotation;
  for (const float part : {q.x, q.y, q.z, q.w}) put(content, part);
  const glm::dvec3& eye = camera.pose.eye;
  for (const double part : {eye.x, eye.y, eye.z}) put(content, part);
  content.insert(content.end(), depth->begin(), depth->end());
  Bytes out;
  put(out, std::string_view("MIRI"));
  put(out, static_cast<std::uint32_t>(content.size()));
  out.insert(out.end(), content.begin(), content.end());
  if (content.size() % 2 != 0) out.push_back(0);
  return out;
}

Result<Bytes> with_chunk(const Bytes& webp, const Camera& camera, const Bytes& chunk) {
  if (webp.size() < kRiffBytes + kChunkBytes || std::memcmp(&webp[kRiffBytes], "VP8 ", 4) != 0) {
    return make_error(ErrorId::kCodec, "the colours of an impostor are no lossy WebP");
  }
  Bytes out;
  put(out, std::string_view("RIFF"));
  // All but the 8 bytes up to here, with the chunk that an extended file begins with.
  put(out,
      static_cast<std::uint32_t>(webp.size() - 8 + kChunkBytes + kExtendedBytes + chunk.size()));
  put(out, std::string_view("WEBPVP8X"));
  put(out, static_cast<std::uint32_t>(kExtendedBytes));
  put(out, std::uint32_t{0});  // no alpha, animation, profile or metadata
  for (const std::uint32_t less : {camera.width - 1, camera.height - 1}) {
    for (const int shift : {0, 8, 16}) out.push_back(static_cast<std::uint8_t>(less >> shift));
  }
  out.insert(out.end(), webp.begin() + kRiffBytes, webp.end());
  out.insert(out.end(), chunk.begin(), chunk.end());
  return out;
}

}  // namespace mirage
