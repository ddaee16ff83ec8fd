#include "server/stage/render_profile.h"

#include <webp/encode.h>
#include <xxhash.h>
#include <zstd.h>

#include <algorithm>

#include "shaders/gl/program.h"

namespace mirage {
namespace {

std::uint64_t hash_of(const std::string& text, std::uint64_t seed) {
  return XXH3_64bits_withSeed(text.data(), text.size(), seed);
}

std::uint64_t hash_of_shaders() {
  std::uint64_t hash = 0;
  for (const std::string_view name : gl::shader_names()) {
    hash = hash_of(std::string(name), hash);
    hash = hash_of(std::string(gl::shader_source(name)), hash);
  }
  return hash;
}

}  // namespace

std::uint64_t RenderProfile::hash() const {
  std::uint64_t hash = hash_of(renderer, shaders);
  hash = hash_of(std::to_string(supersample), hash);
  for (const std::string& codec : codecs) hash = hash_of(codec, hash);
  return std::max<std::uint64_t>(hash, 1);
}

RenderProfile render_profile(const std::string& renderer, int supersample) {
  return {supersample,
          renderer,
          hash_of_shaders(),
          {"zstd " + std::to_string(ZSTD_versionNumber()),
           "webp " + std::to_string(WebPGetEncoderVersion())}};
}

std::uint64_t profiled_revision(std::uint64_t scene_revision, std::uint64_t profile) {
  const std::uint64_t words[] = {scene_revision, profile};
  return XXH3_64bits(words, sizeof(words));
}

}  // namespace mirage
