#pragma once
// A table of figures, as it goes into CSV files and onto the page.

#include <optional>
#include <string>
#include <vector>

#include "protocol/base/result.h"

namespace mirage {

/// Six significant digits; "n/a" for what was not measured, "inf" for what has no limit.
std::string figure(const std::optional<double>& value);
std::string figure(double value);

class Table {
 public:
  explicit Table(std::vector<std::string> columns) : columns_(std::move(columns)) {}

  /// One cell per column; another number of them is a bug and ends the program.
  void add(std::vector<std::string> row);
  const std::vector<std::string>& columns() const { return columns_; }
  const std::vector<std::vector<std::string>>& rows() const { return rows_; }
  /// Index of a column that exists.
  std::size_t column(const std::string& name) const;

  /// RFC 4180, with a header line; cells with separators, quotes or line ends are quoted.
  std::string csv() const;

 private:
  std::vector<std::string> columns_;
  std::vector<std::vector<std::string>> rows_;
};

/// Error kIo.
Result<void> write_file(const std::string& path, const std::string& text);

}  // namespace mirage
