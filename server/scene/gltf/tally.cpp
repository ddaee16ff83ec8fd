#include "server/scene/gltf/tally.h"

#include <algorithm>

namespace mirage::gltf {
namespace {

constexpr std::size_t kMaxExample = 120;

/// Names and messages come from outside, but a warning must be one line.
std::string single_line(std::string_view text) {
  std::string out(text.substr(0, kMaxExample));
  for (char& c : out) {
    if (static_cast<unsigned char>(c) < 0x20 || c == 0x7f) c = ' ';
  }
  return out;
}

}  // namespace

void Tally::add(std::string_view what, std::uint64_t count, std::string_view example) {
  if (count == 0) return;
  auto row = std::find_if(rows_.begin(), rows_.end(), [&](const Row& r) { return r.what == what; });
  if (row == rows_.end()) row = rows_.insert(rows_.end(), Row{std::string(what), {}, 0});
  row->count += count;
  if (row->example.empty()) row->example = single_line(example);
}

Result<void> Tally::forgive(std::string_view what, const Error& defect) {
  if (strict_) return defect;
  add(what, 1, defect.text);
  return {};
}

Result<void> Tally::lose(std::string_view what, const Error& defect) {
  if (!first_loss_) first_loss_ = defect;
  return forgive(what, defect);
}

void Tally::note(std::string line) {
  for (const Row& row : rows_) {
    if (row.what == line) return;
  }
  rows_.push_back({std::move(line), {}, 0});
}

std::vector<std::string> Tally::lines() const {
  std::vector<std::string> out;
  out.reserve(rows_.size());
  for (const Row& row : rows_) {
    std::string line = row.count > 0 ? std::to_string(row.count) + " " + row.what : row.what;
    if (!row.example.empty()) line += " (first: " + row.example + ")";
    out.push_back(std::move(line));
  }
  return out;
}

}  // namespace mirage::gltf
