#pragma once
// Table: figures that go into a CSV file and onto the page.

#include <optional>
#include <string>
#include <vector>

#include "protocol/base/result.h"

namespace mirage {

/// Formats a figure with six significant digits. Writes "n/a" if it was not measured and "inf" if
/// it has no limit.
std::string figure(const std::optional<double>& value);
std::string figure(double value);

class Table {
 public:
  explicit Table(std::vector<std::string> columns) : columns_(std::move(columns)) {}

  /// Adds a row with one cell per column. Another number of cells is a bug and ends the program.
  void add(std::vector<std::string> row);
  const std::vector<std::string>& columns() const { return columns_; }
  const std::vector<std::vector<std::string>>& rows() const { return rows_; }
  /// Returns the index of a column, which must exist.
  std::size_t column(const std::string& name) const;

  /// Returns the table as RFC 4180 with a header line. Cells with separators, quotes or line ends
  /// are quoted.
  std::string csv() const;

 private:
  std::vector<std::string> columns_;
  std::vector<std::vector<std::string>> rows_;
};

/// Writes a file. Error kIo.
Result<void> write_file(const std::string& path, const std::string& text);

}  // namespace mirage
