#pragma once
// Column heads in words: a CSV has names for programs, the page has words for people.

#include <string>

namespace mirage {

struct ColumnWords {
  std::string head;     ///< what stands above the column, with its unit
  std::string tooltip;  ///< one sentence; empty where the head says all
};

/// The words for a column of the report's tables; an unknown name stands for itself.
ColumnWords words_of_column(const std::string& name);

}  // namespace mirage
