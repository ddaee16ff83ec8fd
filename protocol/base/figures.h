#pragma once
// Figures that programs report (statistics, metrics), with unit and meaning: the tables of
// docs/reference are printed from them.

#include <string>
#include <vector>

namespace mirage {

struct Figure {
  std::string name;     ///< as it is written, with dots for nesting: "frame_ms.p95"
  std::string unit;     ///< empty: a count, a share or a text
  std::string meaning;  ///< one sentence
};

/// `text` fit for a cell of a Markdown table.
std::string markdown_cell(std::string text);

/// A Markdown page: title, introduction, a table of the figures.
std::string figures_page(const std::string& title, const std::string& introduction,
                         const std::vector<Figure>& figures);

}  // namespace mirage
