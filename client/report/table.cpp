#include "client/report/table.h"

#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <fstream>

namespace mirage {
namespace {

std::string csv_cell(const std::string& text) {
  if (text.find_first_of(",\"\r\n") == std::string::npos) return text;
  std::string out = "\"";
  for (const char c : text) {
    if (c == '"') out += '"';
    out += c;
  }
  return out + '"';
}

std::string csv_line(const std::vector<std::string>& cells) {
  std::string out;
  for (std::size_t i = 0; i < cells.size(); ++i) out += (i > 0 ? "," : "") + csv_cell(cells[i]);
  return out + "\n";
}

}  // namespace

std::string figure(double value) {
  if (std::isnan(value)) return "n/a";
  if (std::isinf(value)) return value > 0 ? "inf" : "-inf";
  return fmt::format("{:.6g}", value);
}

std::string figure(const std::optional<double>& value) { return value ? figure(*value) : "n/a"; }

void Table::add(std::vector<std::string> row) {
  if (row.size() != columns_.size()) {
    std::fprintf(stderr, "a row of %zu cells for %zu columns\n", row.size(), columns_.size());
    std::abort();
  }
  rows_.push_back(std::move(row));
}

std::size_t Table::column(const std::string& name) const {
  const auto at = std::find(columns_.begin(), columns_.end(), name);
  if (at == columns_.end()) std::abort();
  return static_cast<std::size_t>(at - columns_.begin());
}

std::string Table::csv() const {
  std::string out = csv_line(columns_);
  for (const std::vector<std::string>& row : rows_) out += csv_line(row);
  return out;
}

Result<void> write_file(const std::string& path, const std::string& text) {
  std::ofstream file(path, std::ios::binary);
  file << text;
  file.close();
  if (!file) return make_error(ErrorId::kIo, "cannot write '" + path + "'");
  return {};
}

}  // namespace mirage
