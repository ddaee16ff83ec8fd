#include "server/bake/bake_run.h"

#include <spdlog/fmt/fmt.h>
#include <unistd.h>
#include <xxhash.h>

#include <chrono>
#include <filesystem>
#include <future>

#include "protocol/output/output_folder.h"
#include "server/bake/bake_fit.h"
#include "server/bake/bake_json.h"
#include "server/bake/cut_outs.h"
#include "server/bake/image_bytes.h"
#include "server/prepare/prepared_scene.h"
#include "server/render/gpu_scene.h"
#include "shaders/gl/egl_context.h"

namespace mirage {
namespace {

double now_s() {
  return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

void say(const std::string& line) { std::fprintf(stderr, "%s\n", line.c_str()); }

// Returns the name of the file that is baked as a whole: tree.glb becomes tree.
std::string whole_name(const std::string& scene) {
  const std::string file = scene.substr(0, scene.find('?'));
  if (file.rfind("builtin:", 0) == 0) return file.substr(8);
  return std::filesystem::path(file).stem().string();
}

struct LoadedScene {
  std::shared_ptr<const PreparedScene> scene;
  std::size_t cut_outs = 0;
};

Result<LoadedScene> load(const BakeOptions& options) {
  SceneLoadOptions how;
  how.strict = options.strict;
  how.studio = false;
  how.threads = options.threads;
  how.choice.clip = options.clip;
  how.choice.variant = options.variant;
  how.progress = say;
  Result<Scene> imported = import_scene(options.scene, how);
  if (!imported) return imported.error();
  Scene scene = imported.take();
  for (const std::string& warning : scene.warnings) say("warning: " + warning);
  LoadedScene out;
  out.cut_outs = test_cut_outs(scene);
  Result<std::shared_ptr<const PreparedScene>> prepared = prepare_scene(std::move(scene), how);
  if (!prepared) return prepared.error();
  out.scene = prepared.take();
  return out;
}

/// One run: the subjects of its shard, one after the other. While one is captured, the files of
/// the one before are made by another thread.
class BakeRun {
 public:
  BakeRun(const BakeOptions& options, LoadedScene loaded, std::vector<BakeSubject> subjects)
      : o_(options),
        scene_(std::move(loaded.scene)),
        cut_outs_(loaded.cut_outs),
        subjects_(std::move(subjects)),
        gpu_(scene_),
        renderer_(gpu_),
        workers_(options.threads),
        run_(run_hash(options, scene_->revision)) {}

  Result<void> bake_all(OutputFolder& folder);
  Result<void> dry_run();

 private:
  struct Capture {
    BakedObject object;
    BakeMaster master;
  };
  Result<void> refuse_other_run(const OutputFolder& folder) const;
  bool kept(const OutputFolder& folder, const BakeSubject& subject) const;
  BakeShot first_shot(const BakeSubject& subject) const;
  Result<Capture> capture(const BakeSubject& subject, const std::string& place);
  Result<void> measure(Capture& capture, const BakeSubject& subject);
  Result<void> write(const OutputFolder& folder, Capture capture) const;
  Result<std::string> write_index(const OutputFolder& folder) const;
  std::vector<std::string> warnings(const BakeSubject& subject, const BakeShot& shot) const;

  const BakeOptions& o_;
  std::shared_ptr<const PreparedScene> scene_;
  const std::size_t cut_outs_;
  const std::vector<BakeSubject> subjects_;
  GpuScene gpu_;
  BakeRenderer renderer_;
  Workers workers_;
  const std::string run_;
};

BakeShot BakeRun::first_shot(const BakeSubject& subject) const {
  BakeShot shot;
  shot.layout = o_.layout;
  shot.roll = o_.target->roll;
  shot.grid = o_.grid;
  shot.tile = o_.size / o_.grid;
  NeedMask needs = 0;
  for (const SubjectPart& part : subject.parts) needs |= scene_->objects[part.object].needs;
  shot.samples = o_.samples ? o_.samples : (needs & kNeedAlphaMask) ? 3 : 2;
  shot.center = subject.center;
  shot.radius = framed_radius(*o_.target, subject.radius, subject.extent, shot.tile);
  return shot;
}

std::vector<std::string> BakeRun::warnings(const BakeSubject& subject, const BakeShot& shot) const {
  std::vector<std::string> out;
  if (subject.animated) out.emplace_back("it is animated: its first pose is baked");
  if (subject.blended) {
    out.emplace_back(
        "it has blended layers: a texel keeps their sum, and the depth of the one that shows most");
  }
  if (cut_outs_ > 0) {
    out.push_back(
        fmt::format("{} blended materials are cut-outs: alpha is tested at .5 instead", cut_outs_));
  }
  if (!o_.error_db && shot.tile * shot.grid != o_.size) {
    out.push_back(fmt::format("{} texels are not divisible by {} frames: the picture has {}",
                              o_.size, shot.grid, shot.tile * shot.grid));
  }
  const Result<std::vector<std::string>> target =
      check_target(*o_.target, shot.layout, shot.grid, shot.tile);
  if (target) out.insert(out.end(), target->begin(), target->end());
  return out;
}

Result<BakeRun::Capture> BakeRun::capture(const BakeSubject& subject, const std::string& place) {
  Capture out;
  out.object.name = subject.name;
  out.object.triangles = subject.triangles;
  out.object.extent = subject.extent;
  BakeShot shot = first_shot(subject);
  if (o_.error_db) {
    const Result<FittedBake> fitted =
        fit_bake(renderer_, subject, *o_.target, shot, *o_.error_db, workers_,
                 [&](const std::string& tried) { say(place + ": " + tried); });
    if (!fitted) return fitted.error();
    shot = fitted->shot;
    if (!fitted->reached) {
      out.object.warnings.push_back(fmt::format("{:.1f} dB is the best that was found, not {:g}",
                                                fitted->psnr_db, *o_.error_db));
    }
  }
  double last = now_s();
  Result<BakeMaster> master = renderer_.bake(subject, shot, [&](double share) {
    if (now_s() - last < 2) return true;
    last = now_s();
    say(fmt::format("{}: {:.0f} % of the frames", place, 100 * share));
    return true;
  });
  if (!master) return master.error();
  out.master = master.take();
  out.object.shot = shot;
  const std::vector<std::string> more = warnings(subject, shot);
  out.object.warnings.insert(out.object.warnings.end(), more.begin(), more.end());
  if (Result<void> measured = measure(out, subject); !measured) return measured.error();
  return out;
}

Result<void> BakeRun::measure(Capture& capture, const BakeSubject& subject) {
  if (o_.measure == MeasureChoice::kNone || o_.layout == BakeLayout::kRing) return {};
  ErrorEffort effort;
  effort.offset = 1;  // other directions than those of fit_bake()
  if (o_.error_db) effort.edge = 512;
  if (o_.measure == MeasureChoice::kFull) {
    effort.edge = 512;
    effort.directions = 24;
    effort.radii = {2.5, 4, 12, 40};
  }
  Result<std::vector<BakeErrorRow>> rows =
      measure_bake(renderer_, subject, as_bytes(capture.master), effort, workers_);
  if (!rows) return rows.error();
  capture.object.error = rows.take();
  return {};
}

Result<void> BakeRun::write(const OutputFolder& folder, Capture capture) const {
  ExportChoice choice;
  choice.object = capture.object.name;
  choice.maps = o_.maps;
  choice.linear = o_.format == BakeFormat::kExr;
  Result<BakeExport> made = export_bake(capture.master, *o_.target, choice);
  if (!made) return made.error();
  capture.master = BakeMaster();
  BakedObject& object = capture.object;
  object.maps = std::move(made->maps);
  for (BakeMapFacts& map : object.maps) map.file = with_ending(map.file, o_.format);
  const auto put = [&](const std::string& name, std::span<const std::uint8_t> bytes) {
    object.files.push_back({name, bytes.size(), XXH3_64bits(bytes.data(), bytes.size())});
    return folder.write(name, bytes);
  };
  for (const BakeImage& image : made->images) {
    const Result<std::vector<std::uint8_t>> bytes = image_bytes(image, o_.format);
    if (!bytes) return bytes.error();
    if (Result<void> done = put(with_ending(image.file, o_.format), *bytes); !done) return done;
  }
  for (const BakeText& text : made->texts) {
    const auto* begin = reinterpret_cast<const std::uint8_t*>(text.text.data());
    if (Result<void> done = put(text.file, {begin, text.text.size()}); !done) return done;
  }
  for (const BakeBinary& file : made->binaries) {
    if (Result<void> done = put(file.file, file.bytes); !done) return done;
  }
  // The last file: what it names is there and whole.
  return folder.write(object.name + ".json", object_json(object, o_, run_));
}

bool BakeRun::kept(const OutputFolder& folder, const BakeSubject& subject) const {
  const std::optional<std::string> text = folder.read_text(subject.name + ".json");
  const std::optional<ObjectEntry> entry = text ? read_object_json(*text) : std::nullopt;
  if (!entry || entry->run != run_) return false;
  for (const BakedFile& file : entry->files) {
    const std::optional<Bytes> bytes = folder.read(file.name);
    if (!bytes || XXH3_64bits(bytes->data(), bytes->size()) != file.hash) return false;
  }
  return true;
}

Result<void> BakeRun::refuse_other_run(const OutputFolder& folder) const {
  if (o_.replace) return {};
  for (const std::string& name : folder.names(".json")) {
    const std::optional<std::string> text = folder.read_text(name);
    const std::optional<ObjectEntry> entry = text ? read_object_json(*text) : std::nullopt;
    if (!entry || entry->run == run_) continue;
    return make_error(ErrorId::kUsage,
                      "'" + o_.out + "' holds another bake: " + name +
                          " comes from another scene or other options",
                      "choose another folder, or --replace");
  }
  return {};
}

Result<std::string> BakeRun::write_index(const OutputFolder& folder) const {
  const Result<FileLock> alone = folder.one_at_a_time();
  if (!alone) return alone.error();
  std::vector<ObjectEntry> entries;
  std::vector<std::string> missing;
  for (const BakeSubject& subject : subjects_) {
    const std::optional<std::string> text = folder.read_text(subject.name + ".json");
    std::optional<ObjectEntry> entry = text ? read_object_json(*text) : std::nullopt;
    if (entry && entry->run == run_) {
      entries.push_back(std::move(*entry));
    } else if (subject.radius > 0) {
      missing.push_back(subject.name);
    }
  }
  const std::string index = index_json(entries, missing, o_, run_);
  if (Result<void> written = folder.write("index.json", index); !written) return written.error();
  return index;
}

Result<void> BakeRun::bake_all(OutputFolder& folder) {
  if (Result<void> alone = refuse_other_run(folder); !alone) return alone;
  std::future<Result<void>> writing;
  const auto written = [&]() -> Result<void> {
    return writing.valid() ? writing.get() : Result<void>();
  };
  for (std::size_t i = 0; i < subjects_.size(); ++i) {
    const BakeSubject& subject = subjects_[i];
    if (!o_.shard.has(i)) continue;
    const std::string place = fmt::format("{} of {} '{}'", i + 1, subjects_.size(), subject.name);
    if (!(subject.radius > 0)) {
      say("warning: " + place + " has no extent: it is left out");
      continue;
    }
    if (kept(folder, subject)) {
      say(place + ": is there already");
      continue;
    }
    const double begin = now_s();
    Result<Capture> captured = capture(subject, place);
    if (!captured) return captured.error();
    for (const std::string& warning : captured->object.warnings) say(place + ": " + warning);
    std::string error;
    for (const BakeErrorRow& row : captured->object.error) {
      if (row.method != method_of(*o_.target) || row.radii != 4 || !row.psnr_db) continue;
      error = fmt::format(", {:.1f} dB at 4 radii", *row.psnr_db);
    }
    const BakeShot& shot = captured->object.shot;
    say(fmt::format("{}: {} x {} frames of {} px{}, {:.1f} s", place, shot.grid, shot.grid,
                    shot.tile, error, now_s() - begin));
    if (Result<void> before = written(); !before) return before;
    writing = std::async(std::launch::async, [this, &folder, one = captured.take()]() mutable {
      return write(folder, std::move(one));
    });
  }
  if (Result<void> last = written(); !last) return last;
  const Result<std::string> index = write_index(folder);
  if (!index) return index.error();
  folder.clear_work();
  if (o_.json) std::fputs(index->c_str(), stdout);
  return {};
}

Result<void> BakeRun::dry_run() {
  const std::size_t maps = o_.maps.empty() ? o_.target->maps.size() : o_.maps.size();
  double all_s = 0, all_mib = 0;
  std::size_t count = 0;
  std::puts("object                            triangles  grid  frame px  texture MiB  seconds");
  for (std::size_t i = 0; i < subjects_.size(); ++i) {
    const BakeSubject& subject = subjects_[i];
    if (!o_.shard.has(i) || !(subject.radius > 0)) continue;
    // A bake of few frames tells what one costs.
    BakeShot shot = first_shot(subject), few = shot;
    few.grid = kFewestFrames;
    // The first one compiles shaders.
    if (const Result<BakeMaster> first = renderer_.bake(subject, few); !first) return first.error();
    const double begin = now_s();
    if (const Result<BakeMaster> tried = renderer_.bake(subject, few); !tried) return tried.error();
    const double seconds = (now_s() - begin) * shot.grid * shot.grid / (few.grid * few.grid);
    const double mib = 4.0 * double(maps) * shot.grid * shot.grid * shot.tile * shot.tile / 1048576;
    std::printf("%-32s %10llu %5d %9d %12.1f %8.1f\n", subject.name.c_str(),
                static_cast<unsigned long long>(subject.triangles), shot.grid, shot.tile, mib,
                seconds);
    for (const std::string& warning : warnings(subject, shot))
      std::printf("  %s\n", warning.c_str());
    all_s += seconds;
    all_mib += mib;
    ++count;
  }
  std::printf("%zu objects, %.0f MiB of textures, about %.0f s without measuring\n", count, all_mib,
              all_s);
  return {};
}

}  // namespace

Result<void> run_bake(const BakeOptions& options) {
  // Checks what needs no scene first.
  const Result<std::vector<std::string>> target =
      check_target(*options.target, options.layout, options.grid, options.size / options.grid);
  if (!target && !options.error_db) return target.error();
  std::optional<OutputFolder> folder;
  if (!options.dry_run) {
    Result<OutputFolder> opened = OutputFolder::open(options.out, ".bake", options.shard);
    if (!opened) return opened.error();
    folder.emplace(opened.take());
  }
  Result<LoadedScene> loaded = load(options);
  if (!loaded) return loaded.error();
  SubjectChoice choice;
  choice.names = options.objects;
  choice.whole = options.whole;
  choice.whole_name = whole_name(options.scene);
  Result<std::vector<BakeSubject>> subjects = bake_subjects(*loaded->scene, choice);
  if (!subjects) return subjects.error();
  if (subjects->size() > 1 && options.objects.empty() && isatty(STDERR_FILENO)) {
    say(fmt::format("{} objects; --whole bakes them as one", subjects->size()));
  }
  Result<gl::EglContext> context = gl::EglContext::create(options.device);
  if (!context) return context.error();
  BakeRun run(options, loaded.take(), subjects.take());
  return options.dry_run ? run.dry_run() : run.bake_all(*folder);
}

}  // namespace mirage
