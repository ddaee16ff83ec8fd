#include "server/scene/gltf/image_import.h"

#include <algorithm>
#include <optional>
#include <queue>

#include "server/scene/gltf/file_guard.h"
#include "server/scene/gltf/gltf_limits.h"
#include "server/scene/gltf/image_decode.h"
#include "server/scene/gltf/image_reduce.h"
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
  const std::int32_t place = wanted_place(source, srgb);
  wanted_[static_cast<std::size_t>(place)].drawn = true;
  return place;
}

ImageImporter::Converted ImageImporter::converted(int diffuse, int specular_glossiness,
                                                  const SpecGloss& factors) {
  Conversion conversion;
  conversion.factors = factors;
  if (diffuse >= 0) conversion.diffuse = wanted_place(diffuse, true);
  if (specular_glossiness >= 0) conversion.specular = wanted_place(specular_glossiness, true);
  for (const Conversion& other : conversions_) {
    const bool same = other.diffuse == conversion.diffuse &&
                      other.specular == conversion.specular &&
                      glm::vec3(other.factors.diffuse) == glm::vec3(factors.diffuse) &&
                      other.factors.specular == factors.specular &&
                      other.factors.glossiness == factors.glossiness;
    if (same) return other.to;
  }
  for (const std::int32_t place : {conversion.diffuse, conversion.specular}) {
    if (place < 0) continue;
    Wanted& source = wanted_[static_cast<std::size_t>(place)];
    // An image that is decoded both ways is counted with the first of both.
    const std::size_t first = static_cast<std::size_t>(source.same >= 0 ? source.same : place);
    wanted_[first].uses += 2;
  }
  Wanted made;
  made.made = made.drawn = made.readable = true;
  conversion.to.base = static_cast<std::int32_t>(wanted_.size());
  wanted_.push_back(made);
  made.srgb = false;
  conversion.to.metal_rough = static_cast<std::int32_t>(wanted_.size());
  wanted_.push_back(made);
  conversions_.push_back(conversion);
  return conversion.to;
}

void ImageImporter::convert(const Workers& workers, std::vector<Image>& images) {
  const auto source = [&](std::int32_t place) -> const Image* {
    return place >= 0 && readable(place) ? &images[static_cast<std::size_t>(place)] : nullptr;
  };
  workers.each(conversions_.size(), [&](std::size_t i) {
    const Conversion& c = conversions_[i];
    MetalRoughImages made = convert_images(source(c.diffuse), source(c.specular), c.factors);
    images[static_cast<std::size_t>(c.to.base)] = std::move(made.base);
    images[static_cast<std::size_t>(c.to.metal_rough)] = std::move(made.metal_rough);
  });
  for (std::size_t i = 0; i < wanted_.size(); ++i) {
    if (!wanted_[i].drawn) images[i] = white_pixel();
  }
}

std::int32_t ImageImporter::wanted_place(int source, bool srgb) {
  const auto next = static_cast<std::int32_t>(wanted_.size());
  const auto [entry, is_new] = index_.try_emplace({source, srgb}, next);
  if (!is_new) return entry->second;
  const auto other = index_.find({source, !srgb});
  Wanted wanted;
  wanted.source = source;
  wanted.srgb = srgb;
  if (other != index_.end()) wanted.same = other->second;
  wanted_.push_back(wanted);
  return next;
}

Result<std::span<const std::uint8_t>> ImageImporter::bytes_of(
    int source, std::vector<std::uint8_t>& owned) const {
  const ImageSource& place = document_.images[source];
  if (place.buffer_view >= 0) return document_.view_bytes(place.buffer_view);
  auto loaded = place.file.empty()
                    ? decode_data_uri(place.uri)
                    : read_regular_file(place.file, kMaxImageFileBytes, ErrorId::kSceneUri);
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

std::uint64_t ImageImporter::Wanted::pixels() const {
  return std::uint64_t{halved(header.width, halvings)} * halved(header.height, halvings);
}

std::uint64_t ImageImporter::Wanted::cost() const {
  return halvings > 0 && header.streams ? pixels() : header.pixels();
}

Result<void> ImageImporter::judge(Wanted& wanted) {
  std::vector<std::uint8_t> owned;
  const auto bytes = bytes_of(wanted.source, owned);
  if (!bytes) return leave_out(wanted, bytes.error());
  const auto header = judge_image(*bytes, document_.limits);
  if (header) {
    wanted.readable = true;
    wanted.header = *header;
    return {};
  }
  const Error named =
      make_error(header.error().id, name_of(wanted.source) + ": " + header.error().text);
  // An image that is too large is an error. Leaving it out would silently change the look of the
  // scene.
  if (named.id == ErrorId::kSceneLimit) return named;
  return leave_out(wanted, named);
}

Result<void> ImageImporter::fit() {
  std::priority_queue<std::pair<std::uint64_t, std::size_t>> largest;
  std::uint64_t decoded = 0;
  std::uint64_t held = 0;
  for (std::size_t i = 0; i < wanted_.size(); ++i) {
    Wanted& wanted = wanted_[i];
    if (!wanted.readable || wanted.same >= 0 || wanted.made) continue;
    decoded += wanted.header.pixels();
    held += wanted.pixels() * wanted.uses;
    largest.push({wanted.pixels(), i});
  }
  const SceneLimits& limits = document_.limits;
  if (decoded > limits.decoded_pixels) {
    return limits.exceeded(decoded, limits.decoded_pixels, "pixels in images",
                           "resize IN OUT --width 2048 --height 2048");
  }
  const std::uint64_t in_file = held;
  while (!largest.empty() && (held > kMaxScenePixels || largest.top().first > kMaxImagePixels)) {
    Wanted& wanted = wanted_[largest.top().second];
    const std::size_t place = largest.top().second;
    largest.pop();
    held -= wanted.pixels() * wanted.uses;
    ++wanted.halvings;
    held += wanted.pixels() * wanted.uses;
    if (wanted.pixels() > 1) largest.push({wanted.pixels(), place});
  }
  for (const Wanted& wanted : wanted_) {
    if (wanted.halvings == 0) continue;
    auto ok = tally_.forgive(
        "images reduced to fit",
        make_error(ErrorId::kSceneLimit, name_of(wanted.source) + ": " +
                                             std::to_string(wanted.header.width) + " x " +
                                             std::to_string(wanted.header.height) + " pixels, " +
                                             std::to_string(in_file) + " in all, at most " +
                                             std::to_string(kMaxImagePixels) + " and " +
                                             std::to_string(kMaxScenePixels) + " are held"));
    if (!ok) return ok;
  }
  return {};
}

std::size_t ImageImporter::batch_end(std::size_t begin) const {
  std::uint64_t cost = 0;
  std::size_t end = begin;
  for (; end < wanted_.size(); ++end) {
    if (!wanted_[end].readable || wanted_[end].same >= 0 || wanted_[end].made) continue;
    cost += wanted_[end].cost();
    if (cost > kMaxImagePixels && cost > wanted_[end].cost()) break;
  }
  return std::max(end, begin + 1);
}

Result<std::vector<Image>> ImageImporter::take(const Workers& workers) {
  for (Wanted& wanted : wanted_) {
    if (wanted.made) continue;
    if (Result<void> judged = judge(wanted); !judged) return judged.error();
    if (wanted.same >= 0) ++wanted_[static_cast<std::size_t>(wanted.same)].uses;
  }
  if (Result<void> fits = fit(); !fits) return fits.error();
  std::vector<Image> images(wanted_.size());
  std::vector<std::optional<Error>> damage(wanted_.size());
  const auto decode = [&](std::size_t i) {
    const Wanted& wanted = wanted_[i];
    if (!wanted.readable || wanted.same >= 0 || wanted.made) return;
    std::vector<std::uint8_t> owned;
    const auto bytes = bytes_of(wanted.source, owned);
    Result<Image> image =
        bytes ? decode_image(*bytes, wanted.halvings, wanted.srgb) : bytes.error();
    if (image) {
      images[i] = image.take();
    } else {
      damage[i] = make_error(image.error().id, name_of(wanted.source) + ": " + image.error().text,
                             image.error().hint);
    }
  };
  for (std::size_t begin = 0; begin < wanted_.size();) {
    const std::size_t end = batch_end(begin);
    workers.each(end - begin, [&](std::size_t i) { decode(begin + i); });
    begin = end;
  }
  for (std::size_t i = 0; i < wanted_.size(); ++i) {
    if (damage[i]) {
      // The file is sound, so that leaving its images out would hide a fault of the installation.
      if (damage[i]->id == ErrorId::kModule) return *damage[i];
      if (auto ok = leave_out(wanted_[i], *damage[i]); !ok) return ok.error();
    }
    if (wanted_[i].same >= 0) images[i] = images[static_cast<std::size_t>(wanted_[i].same)];
    if (images[i].rgba.empty()) images[i] = white_pixel();
    images[i].srgb = wanted_[i].srgb;
  }
  convert(workers, images);
  return images;
}

}  // namespace mirage::gltf
