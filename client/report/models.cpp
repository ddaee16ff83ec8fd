#include "client/report/models.h"

#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <filesystem>

#include "client/host/server_process.h"
#include "client/report/session_run.h"
#include "client/report/truth_source.h"
#include "protocol/base/result.h"
#include "protocol/codec/image_codec.h"

namespace mirage {
namespace {

namespace fs = std::filesystem;

constexpr const char* kModelsPart = "models";
constexpr double kModelsFps = 8;
constexpr int kRestFrames = 64;  // 8 s: everything has arrived by then
constexpr int kOrbitFrames = 48, kOrbitEvery = 12;
constexpr std::uint32_t kTruthSamples = 4;
constexpr double kWorsePerGeometry = 0.01;  // FLIP of rounding and of other samples

struct ModelRow {
  std::string file;
  std::string status;  // "ok", or the line of the error
  std::optional<double> ready_s, rss_mb, flip_default, flip_impostors;
  std::optional<double> hue;  // with a viewer's drawing; median over the model's pixels, 1/255
  std::string triangles;
  std::uint64_t violations = 0, compared = 0;
  std::vector<std::string> warnings;
};

Result<std::vector<std::string>> model_files(const std::string& folder) {
  std::vector<std::string> files;
  std::error_code failed;
  for (fs::recursive_directory_iterator at(folder, failed), end; !failed && at != end;
       at.increment(failed)) {
    std::string kind = at->path().extension().string();
    std::transform(kind.begin(), kind.end(), kind.begin(),
                   [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
    if (kind == ".glb" || kind == ".gltf") files.push_back(at->path().string());
  }
  if (failed) return make_error(ErrorId::kIo, folder + ": " + failed.message());
  if (files.empty()) {
    return make_error(ErrorId::kIo, folder + ": no .glb or .gltf file in it or below it");
  }
  std::sort(files.begin(), files.end());
  return files;
}

std::string joined(const std::vector<std::string>& lines) {
  std::string out;
  for (const std::string& line : lines) out += (out.empty() ? "" : "; ") + line;
  return out;
}

std::string cell(const std::optional<double>& value, const char* format = "{:.4f}") {
  return value ? fmt::format(fmt::runtime(format), *value) : "n/a";
}

RunSpec at_rest(const Context& context, const std::string& url) {
  RunSpec spec;
  spec.url = url;
  spec.path = "builtin:still";
  spec.width = context.options.quick ? 320 : 480;
  spec.height = context.options.quick ? 180 : 270;
  spec.fps = kModelsFps;
  spec.frames = kRestFrames;
  spec.compared = {kRestFrames - 1};
  spec.truth_samples = kTruthSamples;
  spec.pictured = spec.compared;
  return spec;
}

RunSpec around(const Context& context, const std::string& url) {
  RunSpec spec = at_rest(context, url);
  spec.path = "builtin:orbit";
  spec.frames = kOrbitFrames;
  spec.compared.clear();
  for (int f = kOrbitEvery; f < kOrbitFrames; f += kOrbitEvery) spec.compared.push_back(f);
  spec.pictured.clear();
  return spec;
}

struct ModelLook {
  std::optional<double> flip;  // at rest
  Picture picture;
};

// Returns the hue error of the drawn picture against the truth, where that shows something.
double hue_median(const Picture& picture) {
  const auto image = [&picture](const std::vector<std::uint8_t>& rgba) {
    Image out;
    out.width = static_cast<std::uint32_t>(picture.width);
    out.height = static_cast<std::uint32_t>(picture.height);
    out.rgba = rgba;
    return out;
  };
  return double{hue_error(image(picture.truth), image(picture.drawn)).median};
}

// Looks at the model at rest and, in the full form, around it.
Result<ModelLook> look_at_model(Context& context, const std::string& url, TruthSource& truth,
                                ModelRow& row) {
  const auto count = [&row](const RunResult& run) {
    row.violations += run.geometric.violations;
    row.compared += run.geometric.compared;
  };
  Result<RunResult> rest = context.runner->run(at_rest(context, url), truth);
  if (!rest) return rest.error();
  count(*rest);
  if (!context.options.quick) {
    const Result<RunResult> moved = context.runner->run(around(context, url), truth);
    if (!moved) return moved.error();
    count(*moved);
  }
  return ModelLook{rest->frames.back().image.flip_mean, std::move(rest->pictures.back())};
}

Result<void> measure_model(Context& context, const std::string& file, ModelRow& row) {
  const std::string& device = context.options.device;
  Result<std::unique_ptr<ServerProcess>> server = ServerProcess::start(file, device);
  if (!server) return server.error();
  row.ready_s = (*server)->ready_s();
  row.triangles = (*server)->ready_value("triangles");
  row.warnings = (*server)->scene_warnings();
  row.rss_mb = (*server)->peak_mb();
  const Result<std::unique_ptr<TruthSource>> truth = TruthSource::open((*server)->url());
  if (!truth) return truth.error();
  const Result<ModelLook> all = look_at_model(context, (*server)->url(), **truth, row);
  if (!all) return all.error();
  row.flip_default = all->flip;
  row.hue = hue_median(all->picture);
  const Result<std::unique_ptr<ServerProcess>> bare =
      ServerProcess::start(file, device, {"--no-geometry", "--references"});
  if (!bare) return bare.error();
  const Result<ModelLook> impostors = look_at_model(context, (*bare)->url(), **truth, row);
  if (!impostors) return impostors.error();
  row.flip_impostors = impostors->flip;
  for (const auto& [how, look] :
       {std::pair("as a viewer draws it", &*all), std::pair("impostors only", &*impostors)}) {
    const std::string caption = fmt::format("{}, {}: FLIP {}.", row.file, how, cell(look->flip));
    if (Result<void> shown = context.page.pictures(caption, look->picture); !shown) return shown;
  }
  return {};
}

Table table_of(const std::vector<ModelRow>& rows) {
  Table table({"file", "status", "ready_s", "rss_mb", "triangles", "flip_default", "flip_impostors",
               "hue_default", "violations", "warnings"});
  for (const ModelRow& row : rows) {
    const bool drawn = row.status == "ok";
    table.add({row.file, row.status, cell(row.ready_s, "{:.2f}"), cell(row.rss_mb, "{:.0f}"),
               row.triangles.empty() ? "n/a" : row.triangles, cell(row.flip_default),
               cell(row.flip_impostors), cell(row.hue, "{:.1f}"),
               drawn ? std::to_string(row.violations) : "n/a", joined(row.warnings)});
  }
  return table;
}

// Returns the value below which a share of the values lies; nullopt: there are none.
std::optional<double> quantile_of(std::vector<double> values, double share) {
  if (values.empty()) return std::nullopt;
  std::sort(values.begin(), values.end());
  return values[static_cast<std::size_t>(share * static_cast<double>(values.size() - 1) + 0.5)];
}

std::string spread_of(const std::vector<ModelRow>& rows, std::optional<double> ModelRow::*value) {
  std::vector<double> values;
  for (const ModelRow& row : rows) {
    if (row.*value) values.push_back(*(row.*value));
  }
  return fmt::format("{} median, {} at the ninetieth percentile, {} at worst",
                     cell(quantile_of(values, 0.5)), cell(quantile_of(values, 0.9)),
                     cell(quantile_of(values, 1)));
}

/// FLIP against the share of the files, for both ways of drawing.
Panel sorted_flip(const std::vector<ModelRow>& rows) {
  Panel panel{"FLIP at rest", "share of the files, %", "FLIP", false, false, {}, {}, {}};
  const std::pair<const char*, std::optional<double> ModelRow::*> ways[] = {
      {"auto", &ModelRow::flip_default}, {"tiles", &ModelRow::flip_impostors}};
  for (const auto& [name, value] : ways) {
    std::vector<double> flips;
    for (const ModelRow& row : rows) {
      if (row.*value) flips.push_back(*(row.*value));
    }
    std::sort(flips.begin(), flips.end());
    Series series{name, {}};
    for (std::size_t i = 0; i < flips.size(); ++i) {
      series.points.emplace_back(
          100.0 * static_cast<double>(i + 1) / static_cast<double>(flips.size()), flips[i]);
    }
    panel.series.push_back(std::move(series));
  }
  return panel;
}

void summarise(Context& context, const std::vector<ModelRow>& rows) {
  std::size_t opened = 0;
  std::uint64_t violations = 0, compared = 0;
  std::vector<std::string> worse;
  for (const ModelRow& row : rows) {
    opened += row.status == "ok";
    violations += row.violations;
    compared += row.compared;
    if (row.flip_default && row.flip_impostors &&
        *row.flip_default > *row.flip_impostors + kWorsePerGeometry) {
      worse.push_back(row.file);
    }
  }
  std::vector<std::string> lines = {
      fmt::format("{} of {} files opened and were drawn.", opened, rows.size()),
      "FLIP at rest, as a viewer draws it: " + spread_of(rows, &ModelRow::flip_default) + ".",
      "FLIP at rest, impostors only: " + spread_of(rows, &ModelRow::flip_impostors) + ".",
      fmt::format("{} of {} compared pixels of impostors exceed their bound.", violations,
                  compared)};
  lines.push_back("Hue as a viewer draws it, median over a model's pixels, of 255: " +
                  spread_of(rows, &ModelRow::hue) + ".");
  lines.push_back(worse.empty()
                      ? fmt::format("None is drawn worse than impostors alone (by more than {}).",
                                    kWorsePerGeometry)
                      : fmt::format("Drawn worse than impostors alone by more than {}: {}.",
                                    kWorsePerGeometry, joined(worse)));
  Page& page = context.page;
  const auto median = [&](std::optional<double> ModelRow::*value) {
    std::vector<double> values;
    for (const ModelRow& row : rows) {
      if (row.*value) values.push_back(*(row.*value));
    }
    return cell(quantile_of(values, 0.5), "{:.3f}");
  };
  page.finding({fmt::format("{} of {}", opened, rows.size()), "files opened and were drawn",
                opened < rows.size()});
  page.finding({median(&ModelRow::flip_default), "FLIP at rest, median"});
  page.finding({median(&ModelRow::flip_impostors), "FLIP at rest with impostors only, median"});
  page.finding({std::to_string(violations), "pixels beyond their bound", violations > 0});
  for (const ModelRow& row : rows) {
    if (row.status != "ok") page.falls_short(row.file + ": " + row.status);
  }
  if (!worse.empty()) page.falls_short(lines.back());
  context.plot("models", {sorted_flip(rows)}, 1,
               "FLIP of each file at rest, the files in the order of their FLIP.");
  page.heading("All files");
  page.list(lines);
  for (const std::string& line : lines) std::puts(line.c_str());
  if (violations > 0) context.failed_checks.push_back(lines[3]);
}

}  // namespace

Result<void> report_models(Context& context) {
  const Result<SessionRunner*> gl = context.graphics();
  if (!gl) return gl.error();
  const std::string& folder = context.options.models_dir;
  const Result<std::vector<std::string>> files = model_files(folder);
  if (!files) return files.error();
  Page& page = context.page;
  page.section(kModelsPart, "Models of " + folder);
  page.command(context.options.command_line);
  page.method(
      "A server of its own serves each file on an ideal link. The viewer looks at it from its home "
      "view for eight seconds at rest, then goes once around it: as it draws by default, and with "
      "impostors only (mirage-server --no-geometry --references). The truth is the server's full "
      "render of the same camera with 4 x 4 samples. FLIP is the mean where either picture shows "
      "something. Hue is the larger change of red - green and of blue - green, by mean over 2 x 2 "
      "pixels. Every pixel of an impostor that the truth shows is compared with its bound.");
  std::vector<ModelRow> rows;
  context.progress.begin(kModelsPart, files->size());
  for (const std::string& file : *files) {
    ModelRow row;
    row.file = fs::path(file).lexically_relative(folder).string();
    context.progress.step(row.file);
    const Result<void> measured = measure_model(context, file, row);
    row.status = measured ? "ok" : measured.error().line();
    rows.push_back(std::move(row));
    // Written after each file, so that a long run that is broken off leaves its rows.
    const Result<void> kept = write_file(context.path("models.csv"), table_of(rows).csv());
    if (!kept) return kept;
  }
  summarise(context, rows);
  page.table(table_of(rows));
  return {};
}

}  // namespace mirage
