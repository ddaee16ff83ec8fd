#include "server/render/tile_shot.h"

#include <time.h>

#include <cstring>

#include "protocol/codec/tile_codec.h"
#include "server/tile/tile_encode.h"
#include "server/tile/tile_measure.h"

namespace mirage {
namespace {

// A software rasteriser uses the processor with its own threads. Wall-clock time would also include
// other users of the machine, so processor time is measured.
double now_ms(bool software) {
  timespec t{};
  clock_gettime(software ? CLOCK_PROCESS_CPUTIME_ID : CLOCK_MONOTONIC, &t);
  return 1e3 * static_cast<double>(t.tv_sec) + 1e-6 * static_cast<double>(t.tv_nsec);
}

std::vector<std::uint8_t> read(GLenum attachment, int edge, GLenum format, GLenum type,
                               std::size_t texel_bytes) {
  std::vector<std::uint8_t> out(static_cast<std::size_t>(edge) * edge * texel_bytes);
  glReadBuffer(attachment);
  glReadPixels(0, 0, edge, edge, format, type, out.data());
  return out;
}

RenderedTile as_rendered(const TileShot& shot, const TileJob& job) {
  auto page = std::make_shared<PagePixels>();
  page->width = page->height = static_cast<int>(shot.edge);
  page->rgba = shot.color;
  page->depth = shot.code;
  page->surface = shot.surface;
  return {job, std::move(page), 0, 0, 0, 0};
}

// Returns the part of a plane inside the crop, with rows going down.
std::vector<std::uint8_t> cut(const std::vector<std::uint8_t>& plane, std::size_t texel_bytes,
                              std::uint32_t edge, const TileCrop& crop) {
  std::vector<std::uint8_t> out;
  for (std::uint32_t y = 0; y < crop.h; ++y) {
    const std::size_t row = std::size_t{edge - 1 - crop.y - y} * edge + crop.x;
    const auto from = plane.begin() + static_cast<std::ptrdiff_t>(row * texel_bytes);
    out.insert(out.end(), from, from + static_cast<std::ptrdiff_t>(crop.w * texel_bytes));
  }
  return out;
}

// Each byte of the depth forms its own plane, which compresses best.
std::size_t fine_depth_bytes(const TileShot& shot, const TileCrop& crop) {
  std::size_t bytes = 0;
  const std::vector<std::uint8_t> texels = cut(shot.fine, 4, shot.edge, crop);
  for (std::size_t part = 0; part < 3; ++part) {
    Tile plane;
    plane.channels = kCasterTile;
    plane.crop = crop;
    for (std::size_t i = part; i < texels.size(); i += 4) plane.depth.push_back(texels[i]);
    bytes += encode_tile_planes(plane, TileCodec::kZstd).size();
  }
  return bytes;
}

// Undoes in advance what the codec will do, so that it compresses the plain colour.
void add_green(std::vector<std::uint8_t>& rgba) {
  for (std::size_t i = 0; i + 3 < rgba.size(); i += 4) {
    rgba[i] = static_cast<std::uint8_t>(rgba[i] + rgba[i + 1]);
    rgba[i + 2] = static_cast<std::uint8_t>(rgba[i + 2] + rgba[i + 1]);
  }
}

template <typename T>
std::size_t differing(const std::vector<std::uint8_t>& a, const std::vector<std::uint8_t>& b) {
  if (a.size() != b.size()) return std::max(a.size(), b.size()) / sizeof(T);
  std::size_t count = 0;
  for (std::size_t i = 0; i + sizeof(T) <= a.size(); i += sizeof(T)) {
    count += std::memcmp(&a[i], &b[i], sizeof(T)) != 0;
  }
  return count;
}

}  // namespace

Result<TileShooter> TileShooter::create(const GpuScene& scene, int supersample,
                                        const TileExtras& extras, bool software) {
  Result<TilePageRenderer> pages = TilePageRenderer::create(scene, supersample, nullptr, extras);
  if (!pages) return pages.error();
  return TileShooter(pages.take(), extras, software);
}

std::optional<TileShot> TileShooter::shoot(const TileJob& job) {
  TileShot shot;
  shot.edge = tile_edge(job.key.size_class);
  const int edge = static_cast<int>(shot.edge);
  PagePacker packer(edge);
  packer.add(shot.edge);
  glFinish();
  const double start = now_ms(software_);
  const gl::RenderTarget* page = pages_.render({job}, packer);
  if (!page) return std::nullopt;
  glBindFramebuffer(GL_READ_FRAMEBUFFER, page->framebuffer());
  glPixelStorei(GL_PACK_ALIGNMENT, 1);
  const bool floats = extras_.float_color;
  shot.color = read(GL_COLOR_ATTACHMENT0, edge, GL_RGBA, floats ? GL_FLOAT : GL_UNSIGNED_BYTE,
                    floats ? 16 : 4);
  const bool relit = job.key.channels == kRelitTile;
  if (relit) shot.surface = read(GL_COLOR_ATTACHMENT2, edge, GL_RGBA, GL_UNSIGNED_BYTE, 4);
  if (extras_.fine_depth) {
    shot.fine = read(GL_COLOR_ATTACHMENT1, edge, GL_RGBA, GL_UNSIGNED_BYTE, 4);
  } else {
    shot.code = read(GL_COLOR_ATTACHMENT1, edge, GL_RED, GL_UNSIGNED_BYTE, 1);
  }
  shot.ms = now_ms(software_) - start;
  for (std::size_t i = 3; i < shot.fine.size(); i += 4) shot.code.push_back(shot.fine[i]);
  return shot;
}

std::size_t differing_components(const TileShot& a, const TileShot& b) {
  const bool floats = a.color.size() == std::size_t{a.edge} * a.edge * 16;
  const std::size_t colors =
      floats ? differing<float>(a.color, b.color) : differing<std::uint8_t>(a.color, b.color);
  const bool both = !a.surface.empty() && !b.surface.empty();
  return colors + (both ? differing<std::uint8_t>(a.surface, b.surface) : 0) +
         differing<std::uint8_t>(a.code, b.code);
}

std::size_t components_out_of_range(const TileShot& shot) {
  std::size_t count = 0;
  for (std::size_t i = 0; i + sizeof(float) <= shot.color.size(); i += sizeof(float)) {
    float value = 0;
    std::memcpy(&value, &shot.color[i], sizeof(value));
    count += !(value >= 0.0f && value <= 1.0f);
  }
  return count;
}

TileCost lean_cost(const TileShot& shot, const TileJob& job, const ObjectDescription& object) {
  const RenderedTile rendered = as_rendered(shot, job);
  const double start = now_ms(true);
  const StoredTilePtr stored = encode_tile(rendered, object, TileCodec::kZstd);
  return {now_ms(true) - start, stored->planes.size()};
}

TileCost full_cost(const TileShot& shot, const TileJob& job, const ObjectDescription& object,
                   const FullCoding& coding) {
  const TileKey& key = job.key;
  const Capture capture(key.cell, key.distance, object.radius, shot.edge);
  const PageTexels page{shot.color.data(), shot.code.data(),
                        shot.surface.empty() ? nullptr : shot.surface.data(),
                        static_cast<int>(shot.edge)};
  const double start = now_ms(true);
  Tile tile = cut_tile(page, key.channels, capture, object);
  if (coding.whole_window) {
    tile.crop = {0, 0, shot.edge, shot.edge};
    tile.rgba = cut(shot.color, 4, shot.edge, tile.crop);
    if (tile.relit()) tile.surface = cut(shot.surface, 4, shot.edge, tile.crop);
    tile.depth = cut(shot.code, 1, shot.edge, tile.crop);
  }
  std::size_t bytes = 0;
  if (coding.fine_depth && !shot.fine.empty()) {
    bytes += fine_depth_bytes(shot, tile.crop);
    std::fill(tile.depth.begin(), tile.depth.end(), 0);
  }
  if (coding.colored) add_green(tile.rgba);
  bytes += encode_tile_planes(tile, TileCodec::kZstd).size();
  tile_content_hash(tile);
  return {now_ms(true) - start, bytes};
}

}  // namespace mirage
