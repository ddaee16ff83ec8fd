#include "client/freeze/finish.h"

#include <spdlog/fmt/fmt.h>
#include <spdlog/spdlog.h>

#include <cmath>
#include <map>
#include <nlohmann/json.hpp>

#include "client/folder/frozen_file.h"
#include "client/freeze/budget.h"
#include "client/freeze/opening.h"
#include "client/freeze/sampler.h"
#include "client/freeze/site.h"
#include "client/host/folder_link.h"
#include "client/host/server_process.h"

namespace mirage {
namespace {

using nlohmann::ordered_json;

constexpr const char* kIndexName = "frozen.json";
constexpr double kMb = 1e6;

std::string settings_text(std::uint64_t revision, const FreezeOptions& o) {
  return fmt::format("{:016x} {}\n", revision, o.settings());
}

std::optional<ordered_json> read_index(const OutputFolder& store) {
  const std::optional<Bytes> file = store.read(kIndexName);
  if (!file || !store.has(kFrozenName)) return std::nullopt;
  ordered_json index = ordered_json::parse(file->begin(), file->end(), nullptr, false);
  if (!index.is_object() || !index.contains("settings") || !index["settings"].is_string() ||
      !index.contains("files") || !index["files"].is_array()) {
    return std::nullopt;
  }
  return index;
}

// Looks at the folder as its viewers will, without the server.
Result<SeenError> look_at_folder(const OutputFolder& store, const FreezeOptions& o,
                                 const std::vector<EyePart>& eyes) {
  Result<std::unique_ptr<FolderLink>> link = FolderLink::open(store.path());
  if (!link) return link.error();
  Sampler sampler(**link, o, [] { return true; });
  if (Result<void> opened = sampler.open(); !opened) return opened.error();
  SeenError out;
  for (const EyePart& part : eyes) {
    for (const EyePart& poses : {part, between(part)}) {
      for (const Pose& pose : poses) {
        const Result<SeenError> seen = sampler.look(pose);
        if (!seen) return seen.error();
        out.add(*seen);
      }
    }
  }
  return out;
}

ordered_json row_of(const std::string& name, const Bytes& file) {
  return {
      {"name", name}, {"bytes", file.size()}, {"hash", fmt::format("{:016x}", frozen_hash(file))}};
}

ordered_json index_of(const FreezeOptions& o, const FinishContext& context, const Kept& kept,
                      const std::map<std::string, Bytes>& others) {
  ordered_json files = ordered_json::array();
  for (const auto& [name, entry] : kept.files) {
    files.push_back(
        {{"name", name}, {"bytes", entry.bytes()}, {"hash", fmt::format("{:016x}", entry.hash())}});
  }
  for (const auto& [name, file] : others) files.push_back(row_of(name, file));
  return {{"format", 1},
          {"scene", o.scene},
          {"revision", fmt::format("{:016x}", context.revision)},
          {"settings", settings_text(context.revision, o)},
          {"files", std::move(files)},
          {"left_out", kept.left_out}};
}

// The worst view may be infinitely wrong, which JSON cannot say.
ordered_json error_of(const FreezeOptions& o, const SeenError& seen) {
  ordered_json worst = nullptr;
  if (std::isfinite(seen.worst_px)) worst = std::round(seen.worst_px * 1000) / 1000;
  return {{"asked_px", o.error_px},
          {"worst_px", worst},
          {"views", seen.views},
          {"views_beyond", seen.beyond},
          {"views_with_holes", seen.bare}};
}

}  // namespace

Result<void> finish(OutputFolder& store, const FreezeOptions& o, const FinishContext& context,
                    const FrozenPart& part, const std::vector<EyePart>& eyes) {
  Result<std::map<std::string, Bytes>> others = fetch_site(context.server.port());
  if (!others) return others.error();
  if (others->empty()) {
    spdlog::warn("the server has no page, so the folder has none: build it with scripts/web");
  }
  std::uint64_t taken = 0;
  for (const auto& [name, file] : *others) taken += file.size();
  // The index has a line a file; the opening is small beside it.
  const Result<std::vector<Bytes>> whole = opening_of(part, within_budget(part, UINT64_MAX));
  if (!whole) return whole.error();
  taken += encode_frozen(*whole).size() + 110 * part.files.size();
  const auto most = static_cast<std::uint64_t>(o.mb * kMb);
  if (taken >= most) {
    return make_error(ErrorId::kUsage, fmt::format("--mb {}: page and index alone take {:.1f} MB",
                                                   o.mb, static_cast<double>(taken) / kMb));
  }
  const Kept kept = within_budget(part, most - taken);
  const Result<std::vector<Bytes>> opening = opening_of(part, kept);
  if (!opening) return opening.error();
  (*others)[kFrozenName] = encode_frozen(*opening);
  for (const auto& [name, file] : *others) {
    if (name == kFrozenName) continue;
    if (Result<void> written = store.write(name, file); !written) return written;
  }
  ordered_json index = index_of(o, context, kept, *others);
  if (Result<void> written = store.write(kFrozenName, others->at(kFrozenName)); !written)
    return written;
  const Result<SeenError> seen = look_at_folder(store, o, eyes);
  if (!seen) return seen.error();
  index["error"] = error_of(o, *seen);
  std::uint64_t bytes = kept.bytes;
  for (const auto& [name, file] : *others) bytes += file.size();
  index["bytes"] = bytes;
  const std::string text = index.dump(1) + "\n";
  if (Result<void> written = store.write(kIndexName, Bytes(text.begin(), text.end())); !written) {
    return written;
  }
  for (const std::string& name : kept.left_out) store.remove(name);
  store.clear_work();
  fmt::print(
      "frozen {}: {} files, {:.1f} MB, error {} px at worst in {} views, {} beyond {} px, {} "
      "with holes; left out {}\n",
      o.out, index["files"].size() + 1, static_cast<double>(bytes + text.size()) / kMb,
      std::isfinite(seen->worst_px) ? fmt::format("{:.2f}", seen->worst_px) : "unbounded",
      seen->views, seen->beyond, o.error_px, seen->bare, kept.left_out.size());
  return {};
}

std::optional<std::string> settings_of(const OutputFolder& store) {
  const std::optional<ordered_json> index = read_index(store);
  if (!index) return std::nullopt;
  return (*index)["settings"].get<std::string>();
}

bool is_finished(const OutputFolder& store, const FreezeOptions& o, std::uint64_t revision) {
  const std::optional<ordered_json> index = read_index(store);
  if (!index || (*index)["settings"] != settings_text(revision, o)) return false;
  for (const ordered_json& row : (*index)["files"]) {
    if (!row.is_object() || !row.contains("name") || !row["name"].is_string()) return false;
    const std::optional<Bytes> file = store.read(row["name"].get<std::string>());
    if (!file || row.value("bytes", std::uint64_t{0}) != file->size() ||
        row.value("hash", "") != fmt::format("{:016x}", frozen_hash(*file))) {
      return false;
    }
  }
  return true;
}

}  // namespace mirage
