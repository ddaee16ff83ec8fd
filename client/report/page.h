#pragma once
// The report's page: one HTML file with everything in it, which opens offline.
//
// The page begins with what was found, and so does each section: figures, then what falls short,
// then plots and tables, and at the end, folded away, how it was measured.

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

/// A figure that answers what a section asks.
struct Finding {
  std::string figure;  ///< with its unit: "0.042", "1.9 Mbit/s", "82 of 82"
  std::string what;    ///< a few words: "FLIP of the walk, mean"
  bool short_of_aim = false;
};

/// Returns the text with the characters that mean something in HTML replaced.
std::string escape_html(const std::string& text);
/// Returns the bytes in Base64 (RFC 4648).
std::string base64(const std::vector<std::uint8_t>& bytes);

class Page {
 public:
  /// Begins a section; all that follows goes into it. `id` is its anchor.
  void section(const std::string& id, const std::string& title);
  /// Adds one of the three to five figures at the head of the section. The first one of each
  /// section also stands at the head of the page; those of a page with one part stand there only.
  void finding(Finding finding);
  /// Adds a line to what falls short, shown in red below the figures.
  void falls_short(const std::string& text);
  /// Adds a paragraph to how the section was measured.
  void method(const std::string& text);
  /// Adds the command that measures the section again.
  void command(const std::string& line);

  void heading(const std::string& title);
  void paragraph(const std::string& text);
  void list(const std::vector<std::string>& items);
  /// `svg`: an element, taken as it is.
  void figure(const std::string& svg, const std::string& caption);
  /// A table whose column heads are words (column_words.h). Numbers stand right; rows whose
  /// `marked` is true are set off. A column that is the same in all rows becomes a line above.
  void table(const Table& table, const std::vector<bool>& marked = {});
  /// A table that is folded away under a line to click on.
  void folded(const std::string& summary, const Table& table);
  /// The drawn picture over the true one with a slider between them, and beside them a map of
  /// FLIP. Error kIo.
  Result<void> pictures(const std::string& caption, const Picture& picture);
  /// Pictures beside each other, each with its label, drawn above true. Error kIo.
  Result<void> strip(const std::string& caption,
                     const std::vector<std::pair<std::string, Picture>>& pictures);

  /// Returns the whole page. `failed`: checks of what must hold that did not; they stand first.
  /// `origin`: lines about the program and machine, at the end.
  std::string html(const std::string& title, const std::vector<std::string>& failed,
                   const std::vector<std::string>& origin) const;

 private:
  struct Section {
    std::string id, title;
    std::vector<Finding> findings;
    std::vector<std::string> shortfalls;
    std::string body, method;
  };
  Section& current();

  std::vector<Section> sections_;
};

}  // namespace mirage
