#include "server/scene/gltf/image_import.h"

#include <algorithm>
#include <optional>

#include "server/scene/gltf/gltf_limits.h"
#include "server/scene/gltf/image_decode.h"
#include "server/scene/gltf/uri_loader.h"

namespace mirage::gltf {
namespace {

std::string name_of(int source) { return "images[" + std::to_string(source) + "]"; }

Image white_pixel() {
  Image image;
  image.width = 1;
  image.height = 1;
  image.rgba.assign(4, 255);
  return image;
}

}  // namespace

std::int32_t ImageImporter::index_of(int source, bool srgb) {
  const auto next = static_cast<std::int32_t>(wanted_.size());
  const auto [entry, is_new] = index_.try_emplace({source, srgb}, next);
  if (!is_new) return entry->second;
  const auto other = index_.find({source, !srgb});
  wanted_.push_back({source, srgb, false, other == index_.end() ? -1 : other->second});
  return next;
}

Result<std::span<const std::uint8_t>> ImageImporter::bytes_of(
    int source, std::vector<std::uint8_t>& owned) const {
  const ImageSource& place = document_.images[source];
  if (place.buffer_view >= 0) return document_.view_bytes(place.buffer_view);
  auto loaded = load_uri(place.uri, document_.folder, kMaxFileBytes, name_of(source));
  if (!loaded) return loaded.error();
  owned = loaded.take();
  return std::span<const std::uint8_t>(owned);
}

void ImageImporter::leave_white(Wanted& wanted, const Error& error) {
  wanted.readable = false;
  tally_.add("unreadable images replaced by white", 1, error.text);
}

// Adds what the image will take to `pixels`.
Result<void> ImageImporter::judge(Wanted& wanted, std::uint64_t& pixels) {
  std::vector<std::uint8_t> owned;
  const auto bytes = bytes_of(wanted.source, owned);
  if (!bytes) {
    leave_white(wanted, bytes.error());
    return {};
  }
  const auto own = count_pixels(*bytes, std::min(kMaxImagePixels, kMaxScenePixels - pixels));
  if (own) {
    wanted.readable = true;
    pixels += *own;
    return {};
  }
  const Error named = make_error(own.error().id, name_of(wanted.source) + ": " + own.error().text);
  // Too large is no damage to paper over: the scene would look wrong without a word.
  if (named.id == ErrorId::kSceneLimit) return named;
  leave_white(wanted, named);
  return {};
}

Result<std::vector<Image>> ImageImporter::take(const Workers& workers) {
  std::uint64_t pixels = 0;
  for (Wanted& wanted : wanted_) {
    if (Result<void> judged = judge(wanted, pixels); !judged) return judged.error();
  }
  std::vector<Image> images(wanted_.size());
  std::vector<std::optional<Error>> damage(wanted_.size());
  workers.each(wanted_.size(), [&](std::size_t i) {
    const Wanted& wanted = wanted_[i];
    if (!wanted.readable || wanted.same >= 0) return;
    std::vector<std::uint8_t> owned;
    const auto bytes = bytes_of(wanted.source, owned);
    Result<Image> image = bytes ? decode_image(*bytes, kMaxImagePixels) : bytes.error();
    if (image) {
      images[i] = image.take();
    } else {
      damage[i] = make_error(image.error().id, name_of(wanted.source) + ": " + image.error().text);
    }
  });
  for (std::size_t i = 0; i < wanted_.size(); ++i) {
    if (damage[i]) leave_white(wanted_[i], *damage[i]);
    if (wanted_[i].same >= 0) images[i] = images[static_cast<std::size_t>(wanted_[i].same)];
    if (images[i].rgba.empty()) images[i] = white_pixel();
    images[i].srgb = wanted_[i].srgb;
  }
  return images;
}

}  // namespace mirage::gltf
