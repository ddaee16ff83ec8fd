#include "client/report/codecs.h"

#include <spdlog/fmt/fmt.h>
#include <time.h>

#include <algorithm>
#include <cmath>

#include "client/frame/draw_list.h"
#include "client/report/session_run.h"
#include "client/report/tile_probe.h"
#include "client/report/truth_source.h"
#include "client/scene/scene_view.h"
#include "protocol/codec/tile_codec.h"
#include "protocol/codec/tile_color.h"
#include "protocol/impostor/camera.h"

namespace mirage {
namespace {

constexpr const char* kCodecsPart = "fidelity";
constexpr int kPasses = 3;  // the quickest counts

struct CodecRow {
  TileCodec codec = TileCodec::kRaw;
  double bytes = 0;                     ///< mean bytes of a tile
  double rms = 0, psnr_db = 0;          ///< error of covered colours; rms in 1/255
  int worst = 0;                        ///< largest error of a texel, 1/255
  double encode_us = 0, decode_us = 0;  ///< mean CPU time of a tile
};

double cpu_us() {
  timespec t{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &t);
  return 1e6 * static_cast<double>(t.tv_sec) + 1e-3 * static_cast<double>(t.tv_nsec);
}

Result<CodecRow> measure(const std::vector<Tile>& tiles, TileCodec codec) {
  CodecRow row;
  row.codec = codec;
  row.encode_us = row.decode_us = INFINITY;
  std::vector<Tile> decoded = tiles;
  std::vector<std::vector<std::uint8_t>> encoded(tiles.size());
  const auto count = static_cast<double>(tiles.size());
  for (int pass = 0; pass < kPasses; ++pass) {
    double began = cpu_us();
    for (std::size_t i = 0; i < tiles.size(); ++i) {
      encoded[i] = encode_tile_planes(tiles[i], codec);
    }
    row.encode_us = std::min(row.encode_us, (cpu_us() - began) / count);
    began = cpu_us();
    for (std::size_t i = 0; i < tiles.size(); ++i) {
      const Result<void> done =
          decode_tile_planes(encoded[i].data(), encoded[i].size(), codec, decoded[i]);
      if (!done) return done.error();
    }
    row.decode_us = std::min(row.decode_us, (cpu_us() - began) / count);
  }
  double squares = 0;
  for (std::size_t i = 0; i < tiles.size(); ++i) {
    const ColorError error = color_error(tiles[i].rgba, decoded[i].rgba);
    squares += double{error.rms} * error.rms / count;
    row.worst = std::max<int>(row.worst, error.max);
    row.bytes += static_cast<double>(encoded[i].size()) / count;
  }
  row.rms = std::sqrt(squares);
  row.psnr_db = squares > 0 ? 10 * std::log10(255.0 * 255.0 / squares) : INFINITY;
  return row;
}

// Returns a tile of every visible object, of the size that a picture of 640 x 360 from the scene's
// home view needs.
Result<std::vector<Tile>> tiles_in_sight(Context& context, const OpenScene& scene) {
  Result<std::unique_ptr<TileProbe>> probe =
      TileProbe::open(scene.url, scene.truth->scene().lighting, context.runner->renderer());
  if (!probe) return probe.error();
  std::vector<Tile> tiles;
  (*probe)->on_tile = [&](const Tile& tile) {
    if (tile.crop.area() > 0) tiles.push_back(tile);
  };
  const SceneView& view = (*probe)->scene();
  Camera camera;
  camera.width = 640;
  camera.height = 360;
  camera.fov_y = 60 * 0.017453292519943295;
  camera.pose = look_at(view.home.eye, view.home.target);
  camera.fit_depth_range(view.bounds_center, view.bounds_radius);
  const Result<DrawList> list = (*probe)->capture(camera, camera, DrawMethod::kQuad);
  if (!list) return list.error();
  return tiles;
}

Panel panel_of(const std::string& scene, const std::vector<CodecRow>& rows) {
  Panel panel;
  panel.title = scene;
  panel.x_label = "bytes a tile";
  panel.y_label = "RMS error of covered colours, 1/255";
  panel.log_x = true;
  for (const CodecRow& row : rows) {
    panel.series.push_back({codec_name(row.codec), {{row.bytes, row.rms}}});
  }
  return panel;
}

}  // namespace

Result<void> report_codecs(Context& context) {
  Page& page = context.page;
  page.heading("Codecs: bytes against error");
  page.method(fmt::format(
      "Codecs: a tile of every object, as large as a picture of 640 x 360 from the scene's first "
      "view wants it; the mean over tiles. PSNR of the colours of covered texels; coverage, depth "
      "and normals are exact in all. CPU time of one thread, the quickest of {} passes. Decoding "
      "is "
      "what a client does before it uploads the tile.",
      kPasses));
  Table table({"scene", "tiles", "codec", "bytes_a_tile", "color_psnr_db", "color_rms", "color_max",
               "encode_us", "decode_us"});
  std::vector<Panel> panels;
  const std::string& model = context.options.model;
  for (const std::string& name : model.empty()
                                     ? context.scenes_or({"builtin:forest", "builtin:clutter"})
                                     : std::vector<std::string>{model}) {
    const Result<OpenScene*> scene = context.open(name);
    if (!scene) return scene.error();
    const Result<std::vector<Tile>> tiles = tiles_in_sight(context, **scene);
    if (!tiles) return tiles.error();
    if (tiles->empty()) {
      context.omit(kCodecsPart, "codecs, " + name, "no object has a tile from its first view");
      continue;
    }
    std::vector<CodecRow> rows;
    for (const TileCodec codec : kTileCodecs) {
      const Result<CodecRow> row = measure(*tiles, codec);
      if (!row) return row.error();
      rows.push_back(*row);
      table.add({name, std::to_string(tiles->size()), codec_name(codec),
                 fmt::format("{:.0f}", row->bytes), fmt::format("{:.1f}", row->psnr_db),
                 fmt::format("{:.2f}", row->rms), std::to_string(row->worst),
                 fmt::format("{:.0f}", row->encode_us), fmt::format("{:.0f}", row->decode_us)});
    }
    panels.push_back(panel_of(name, rows));
  }
  if (!panels.empty()) {
    context.plot("codecs", panels, 2, "Bytes of a tile against the error of its colours.");
  }
  page.table(table);
  return write_file(context.path("codecs.csv"), table.csv());
}

}  // namespace mirage
