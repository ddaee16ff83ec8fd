#pragma once
// The report's page: one HTML file with everything in it.

#include <cstdint>
#include <string>
#include <utility>
#include <vector>

#include "client/report/table.h"

namespace mirage {

/// Drawn and true pixels of one frame, RGBA8 in sRGB, rows from the top.
struct Picture {
  int width = 0, height = 0;
  std::vector<std::uint8_t> drawn, truth;
};

/// Text with the characters that mean something in HTML replaced.
std::string escape_html(const std::string& text);
std::string base64(const std::vector<std::uint8_t>& bytes);

class Page {
 public:
  /// A section and its entry in the contents list.
  void section(const std::string& id, const std::string& title);
  void heading(const std::string& title);
  void paragraph(const std::string& text);
  void list(const std::vector<std::string>& items);
  void command(const std::string& line);
  /// `svg`: an element, taken as it is.
  void figure(const std::string& svg, const std::string& caption);
  /// Numbers stand right; rows whose `marked` is true are set off.
  void table(const Table& table, const std::vector<bool>& marked = {});
  /// The same, folded away under a line to click on.
  void folded(const std::string& summary, const Table& table);
  /// Drawn, true and twice the difference beside each other. Error kIo.
  Result<void> pictures(const std::string& caption, const Picture& picture);
  /// Beside each other, each with its label, drawn above true. Error kIo.
  Result<void> strip(const std::string& caption,
                     const std::vector<std::pair<std::string, Picture>>& pictures);

  /// The whole page; `summary` comes before the contents.
  std::string html(const std::string& title, const std::vector<std::string>& summary) const;

 private:
  std::string body_;
  std::string contents_;
};

}  // namespace mirage
