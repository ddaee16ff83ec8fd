#include "server/scene/gltf/image_import.h"

#include <algorithm>
#include <optional>

#include "server/scene/gltf/file_guard.h"
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
  auto loaded = place.file.empty()
                    ? decode_data_uri(place.uri)
                    : read_regular_file(place.file, kMaxFileBytes, ErrorId::kSceneUri);
  if (!loaded) {
    return make_error(loaded.error().id, name_of(source) + ": " + loaded.error().text);
  }
  owned = loaded.take();
  return std::span<const std::uint8_t>(owned);
}

Result<void> ImageImporter::leave_out(Wanted& wanted, const Error& error) {
  wanted.readable = false;
  return tally_.forgive("unreadable images left out", error);
}

bool ImageImporter::readable(std::int32_t place) const {
  const Wanted& wanted = wanted_[static_cast<std::size_t>(place)];
  return wanted.same >= 0 ? wanted_[static_cast<std::size_t>(wanted.same)].readable
                          : wanted.readable;
}

// Adds what the image will take to `pixels`.
Result<void> ImageImporter::judge(Wanted& wanted, std::uint64_t& pixels) {
  std::vector<std::uint8_t> owned;
  const auto bytes = bytes_of(wanted.source, owned);
  if (!bytes) return leave_out(wanted, bytes.error());
  const auto own = count_pixels(*bytes, std::min(kMaxImagePixels, kMaxScenePixels - pixels));
  if (own) {
    wanted.readable = true;
    pixels += *own;
    return {};
  }
  const Error named = make_error(own.error().id, name_of(wanted.source) + ": " + own.error().text);
  // Too large is no damage to paper over: the scene would look wrong without a word.
  if (named.id == ErrorId::kSceneLimit) return named;
  return leave_out(wanted, named);
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
    if (damage[i]) {
      if (auto ok = leave_out(wanted_[i], *damage[i]); !ok) return ok.error();
    }
    if (wanted_[i].same >= 0) images[i] = images[static_cast<std::size_t>(wanted_[i].same)];
    if (images[i].rgba.empty()) images[i] = white_pixel();
    images[i].srgb = wanted_[i].srgb;
  }
  return images;
}

}  // namespace mirage::gltf
