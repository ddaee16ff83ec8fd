#include "server/download/download_request.h"

#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <filesystem>

#include "protocol/model/view_place.h"

namespace mirage {
namespace {

constexpr double kFarthest = 1e9, kMostReach = 100;  // m
constexpr int kMostNumber = 1'000'000'000;
constexpr std::size_t kLongestTarget = 20;

template <class T>
std::optional<T> number(const std::string& text, T low, T high) {
  T out{};
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), out);
  const bool whole = error == std::errc() && end == text.data() + text.size();
  if (!whole || !(out >= low && out <= high)) return std::nullopt;
  return out;
}

std::optional<glm::dvec3> point(const std::string& text) {
  glm::dvec3 out(0);
  std::size_t from = 0;
  for (int i = 0; i < 3; ++i) {
    const std::size_t comma = i < 2 ? text.find(',', from) : text.size();
    if (comma == std::string::npos) return std::nullopt;
    const auto read = number<double>(text.substr(from, comma - from), -kFarthest, kFarthest);
    if (!read) return std::nullopt;
    out[i] = *read;
    from = comma + 1;
  }
  return out;
}

// Each reads one value. Returns what is wrong with it; empty: nothing.
std::string take(BakeDownload& bake, const std::string& name, const std::string& value) {
  if (name == "object") {
    const auto read = number<int>(value, 0, kMostNumber);
    if (read) bake.object = static_cast<unsigned>(*read);
    return read ? "" : "object is not the number of one";
  }
  if (name == "target") {
    const bool plain = std::all_of(value.begin(), value.end(), [](char c) {
      return (c >= 'a' && c <= 'z') || (c >= '0' && c <= '9') || c == '-';
    });
    if (!plain || value.empty() || value[0] == '-' || value.size() > kLongestTarget) {
      return "target is not the name of one";
    }
    bake.target = value;
    return "";
  }
  if (name == "grid" || name == "size") {
    const bool grid = name == "grid";
    const auto read = grid ? number<int>(value, 2, 32) : number<int>(value, 64, 4096);
    if (!read) return grid ? "grid is not 2 to 32 frames" : "size is not 64 to 4096 texels";
    (grid ? bake.grid : bake.size) = *read;
    return "";
  }
  return "there is no '" + name.substr(0, 40) + "': a bake has object, target, grid and size";
}

std::string take(FolderDownload& folder, const std::string& name, const std::string& value) {
  if (name == "eye" || name == "look") {
    auto& into = name == "eye" ? folder.eye : folder.look;
    into = point(value);
    return into ? "" : name + " is not three numbers up to 1e9: X,Y,Z";
  }
  if (name == "reach") {
    const auto read = number<double>(value, 0, kMostReach);
    if (read) folder.reach_m = *read;
    return read ? "" : fmt::format("reach is not 0 to {} metres", kMostReach);
  }
  if (name == "mb") {
    const auto read = number<int>(value, 1, 100);
    if (read) folder.mb = *read;
    return read ? "" : "mb is not 1 to 100";
  }
  return "there is no '" + name.substr(0, 40) + "': a folder has eye, look, reach and mb";
}

// Returns a file's name without its ending, or a built-in scene's, with plain characters alone.
std::string plain_name(const std::string& scene) {
  const std::string builtin = "builtin:";
  std::string out = scene.starts_with(builtin) ? scene.substr(builtin.size())
                                               : std::filesystem::path(scene).stem().string();
  std::replace_if(
      out.begin(), out.end(),
      [](unsigned char c) { return std::isalnum(c) == 0 && c != '-' && c != '_'; }, '-');
  return out.empty() ? "scene" : out.substr(0, 60);
}

}  // namespace

std::variant<DownloadRequest, std::string> read_download_request(
    const std::vector<std::pair<std::string, std::string>>& values) {
  const auto kind = std::find_if(values.begin(), values.end(),
                                 [](const auto& one) { return one.first == "kind"; });
  DownloadRequest out;
  if (kind == values.end() || (kind->second != "bake" && kind->second != "folder")) {
    return "kind is not bake or folder";
  }
  if (kind->second == "folder") out = FolderDownload{};
  for (const auto& [name, value] : values) {
    if (name == "kind") continue;
    const auto read = [&name = name, &value = value](auto& one) { return take(one, name, value); };
    if (std::string wrong = std::visit(read, out); !wrong.empty()) return wrong;
  }
  const auto* folder = std::get_if<FolderDownload>(&out);
  if (folder && folder->eye.has_value() != folder->look.has_value()) {
    return "eye and look come together";
  }
  if (folder && folder->eye && !(glm::length(*folder->look - *folder->eye) > 0)) {
    return "look is where the eye is";
  }
  return out;
}

std::string download_program(const DownloadRequest& request) {
  return std::holds_alternative<BakeDownload>(request) ? "mirage-bake" : "mirage-freeze";
}

std::vector<std::string> download_arguments(const DownloadRequest& request,
                                            const DownloadScene& scene, const std::string& out) {
  std::vector<std::string> line = {scene.scene, "--out", out, "--device", scene.device};
  if (const auto* bake = std::get_if<BakeDownload>(&request)) {
    line.insert(line.end(), {"--target", bake->target, "--grid", std::to_string(bake->grid),
                             "--size", std::to_string(bake->size)});
    if (!bake->object) line.emplace_back("--whole");
    if (bake->object) line.insert(line.end(), {"--object", std::to_string(*bake->object)});
    return line;
  }
  const auto& folder = std::get<FolderDownload>(request);
  line.insert(line.end(), {"--mb", std::to_string(folder.mb)});
  if (!scene.environment.empty()) line.insert(line.end(), {"--environment", scene.environment});
  if (!scene.look.empty()) line.insert(line.end(), {"--look", scene.look});
  if (!scene.geometry) line.emplace_back("--no-geometry");
  if (folder.eye) {
    const glm::dvec3 reach(folder.reach_m, 0, folder.reach_m);
    const glm::dvec3 low = *folder.eye - reach, high = *folder.eye + reach;
    line.insert(
        line.end(),
        {"--box", fmt::format("{},{},{},{},{},{}", low.x, low.y, low.z, high.x, high.y, high.z),
         "--home", to_text(ViewPlace{*folder.eye, *folder.look})});
  }
  return line;
}

std::string download_name(const DownloadRequest& request, const DownloadScene& scene) {
  const std::string name = plain_name(scene.scene);
  const auto* bake = std::get_if<BakeDownload>(&request);
  if (!bake) return name + "-folder.zip";
  return name + (bake->object ? fmt::format("-{}", *bake->object) : "") + "-" + bake->target +
         ".zip";
}

}  // namespace mirage
