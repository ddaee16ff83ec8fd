// Slow tiles, drawn slice by slice.
#include <algorithm>

#include "protocol/impostor/tile_key.h"
#include "server/render/tile_layers.h"
#include "server/render/tile_page.h"

namespace mirage {
namespace {

/// Appends rows to a plane. Memory grows with the rows, because touching that of a large tile at
/// once would take longer than a slice.
void append_rows(std::vector<std::uint8_t>& plane, GLenum attachment, GLenum format,
                 const RowBand& rows, int edge) {
  const std::size_t components = format == GL_RGBA ? 4 : 1;
  const std::size_t from = plane.size();
  plane.resize(from + components * static_cast<std::size_t>(edge) * rows.rows());
  glReadBuffer(attachment);
  glReadPixels(0, 0, edge, static_cast<GLsizei>(rows.rows()), format, GL_UNSIGNED_BYTE,
               &plane[from]);
}

}  // namespace

bool TilePageRenderer::begin_slow(const TileJob& job, double slice_samples) {
  slow_.reset();
  Path& path = path_of(job);
  const Path& page_path = &path == &relit_ ? relit_ : lit_;
  const int edge = static_cast<int>(tile_edge(job.key.size_class)), big = edge * samples(job);
  const int page_edge = lit_.page.width();
  if (!prepare_drawn(path, big, page_edge)) return false;
  if (job.key.channels == kLayeredTile && !prepare_layers(big, page_edge)) return false;
  if (touching(job) && !prepare_touching(big, page_edge)) return false;
  auto next = std::make_unique<Slow>();
  next->job = job;
  // Each slice draws all triangles, so a slice is at least as much work as they are.
  const double work = std::max(slice_samples, kSamplesPerTriangle * triangles(job));
  // Averaging a texel's samples and reading it back takes as long as shading one sample.
  const double rows = work / (double{1} * big * samples(job) + edge);
  next->slice_rows = static_cast<int>(std::clamp(rows, 1.0, double{1} * edge));
  if (gpu_bytes() + gl::target_bytes(edge, next->slice_rows, page_formats(page_path), 0) >
      most_bytes_) {
    return false;
  }
  next->page = gl::RenderTarget(edge, next->slice_rows, page_formats(page_path), 0);
  if (!next->page.ok()) return false;
  const std::size_t texels = static_cast<std::size_t>(edge) * static_cast<std::size_t>(edge);
  next->pixels = std::make_shared<PagePixels>();
  next->pixels->width = next->pixels->height = edge;
  next->pixels->rgba.reserve(texels * 4);
  next->pixels->depth.reserve(texels);
  if (writes_surface({job})) next->pixels->surface.reserve(texels * 4);
  slow_ = std::move(next);
  return true;
}

std::shared_ptr<const PagePixels> TilePageRenderer::draw_slow_slice() {
  Slow& slow = *slow_;
  const int edge = slow.pixels->width, last = std::min(slow.done_rows + slow.slice_rows, edge);
  const RowBand rows{static_cast<std::uint32_t>(slow.done_rows), static_cast<std::uint32_t>(last)};
  glEnable(GL_FRAMEBUFFER_SRGB);
  glEnable(GL_DEPTH_CLAMP);
  draw_tile(slow.job, rows);
  resolve(slow.job, slow.page, {0, -slow.done_rows});
  glBindFramebuffer(GL_READ_FRAMEBUFFER, slow.page.framebuffer());
  glBindBuffer(GL_PIXEL_PACK_BUFFER, 0);
  glPixelStorei(GL_PACK_ALIGNMENT, 1);
  append_rows(slow.pixels->rgba, GL_COLOR_ATTACHMENT0, GL_RGBA, rows, edge);
  append_rows(slow.pixels->depth, GL_COLOR_ATTACHMENT1, GL_RED, rows, edge);
  if (writes_surface({slow.job})) {
    append_rows(slow.pixels->surface, GL_COLOR_ATTACHMENT2, GL_RGBA, rows, edge);
  }
  slow.done_rows = last;
  if (last < edge) return nullptr;
  std::shared_ptr<const PagePixels> whole = std::move(slow.pixels);
  slow_.reset();
  return whole;
}

}  // namespace mirage
