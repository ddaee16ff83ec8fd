#include "protocol/base/figures.h"

namespace mirage {

std::string markdown_cell(std::string text) {
  const auto replace = [&text](const std::string& what, const std::string& with) {
    for (std::size_t at = 0; (at = text.find(what, at)) != std::string::npos; at += with.size()) {
      text.replace(at, what.size(), with);
    }
  };
  replace("|", "\\|");   // a bar would end the cell
  replace("<", "&lt;");  // an angle bracket would begin a tag
  replace("\n", " ");
  return text;
}

std::string figures_page(const std::string& title, const std::string& introduction,
                         const std::vector<Figure>& figures) {
  std::string out =
      "# " + title + "\n\n" + introduction + "\n\n| name | unit | meaning |\n|---|---|---|\n";
  for (const Figure& figure : figures) {
    out += "| `" + markdown_cell(figure.name) + "` | " + markdown_cell(figure.unit) + " | " +
           markdown_cell(figure.meaning) + " |\n";
  }
  return out;
}

}  // namespace mirage
