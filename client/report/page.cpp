#include "client/report/page.h"

#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <cstdlib>

#include "client/report/column_words.h"
#include "client/report/page_style.h"

namespace mirage {
namespace {

bool is_number(const std::string& text) {
  if (text == "n/a" || text == "inf") return true;
  char* end = nullptr;
  std::strtod(text.c_str(), &end);
  return !text.empty() && *end == '\0';
}

/// A number with at most four digits that mean something; the CSV has them all.
std::string shortened(const std::string& cell) {
  const bool fraction = is_number(cell) && cell.find_first_of(".e") != std::string::npos;
  return fraction ? fmt::format("{:.4g}", std::strtod(cell.c_str(), nullptr)) : cell;
}

std::string paragraph_of(const std::string& text) { return "<p>" + escape_html(text) + "</p>\n"; }

std::string list_of(const std::vector<std::string>& items) {
  std::string out = "<ul>\n";
  for (const std::string& item : items) out += "<li>" + escape_html(item) + "</li>\n";
  return out + "</ul>\n";
}

std::string card(const Finding& finding, const std::string& anchor) {
  std::string inside =
      "<b>" + escape_html(finding.figure) + "</b><span>" + escape_html(finding.what) + "</span>";
  if (!anchor.empty()) inside = "<a href=\"#" + escape_html(anchor) + "\">" + inside + "</a>";
  return (finding.short_of_aim ? "<li class=\"short\">" : "<li>") + inside + "</li>\n";
}

std::string shortfalls_of(const std::string& title, const std::vector<std::string>& lines) {
  if (lines.empty()) return "";
  return "<div class=\"shortfalls\"><b>" + escape_html(title) + "</b>\n" + list_of(lines) +
         "</div>\n";
}

/// True for the columns whose cell is the same in all rows, but for those of a table in which only
/// one column differs.
std::vector<bool> constant_columns(const Table& table) {
  std::vector<bool> out(table.columns().size(), false);
  if (table.rows().size() < 2) return out;
  for (std::size_t c = 0; c < out.size(); ++c) {
    out[c] = true;
    for (const std::vector<std::string>& row : table.rows()) {
      if (row[c] != table.rows().front()[c]) out[c] = false;
    }
  }
  if (std::count(out.begin(), out.end(), false) < 2) out.assign(out.size(), false);
  return out;
}

std::string head_of(const std::string& column) {
  const ColumnWords words = words_of_column(column);
  const std::string tip =
      words.tooltip.empty() ? "" : " title=\"" + escape_html(words.tooltip) + "\"";
  return "<th scope=\"col\"" + tip + ">" + escape_html(words.head) + "</th>";
}

std::string table_of(const Table& table, const std::vector<bool>& marked) {
  const std::vector<bool> constant = constant_columns(table);
  std::string same, head;
  for (std::size_t c = 0; c < constant.size(); ++c) {
    if (!constant[c]) {
      head += head_of(table.columns()[c]);
    } else if (!table.rows().front()[c].empty()) {
      same += (same.empty() ? "" : "; ") + words_of_column(table.columns()[c]).head + " " +
              table.rows().front()[c];
    }
  }
  std::string out = same.empty() ? "" : paragraph_of("In all rows: " + same + ".");
  out += "<div class=\"wide\"><table>\n<thead><tr>" + head + "</tr></thead>\n<tbody>\n";
  for (std::size_t i = 0; i < table.rows().size(); ++i) {
    out += i < marked.size() && marked[i] ? "<tr class=\"marked\">" : "<tr>";
    for (std::size_t c = 0; c < constant.size(); ++c) {
      if (constant[c]) continue;
      const std::string& cell = table.rows()[i][c];
      out += (is_number(cell) ? "<td class=\"number\">" : "<td>") + escape_html(shortened(cell)) +
             "</td>";
    }
    out += "</tr>\n";
  }
  return out + "</tbody></table></div>\n";
}

}  // namespace

std::string escape_html(const std::string& text) {
  std::string out;
  for (const char c : text) {
    switch (c) {
      case '&':
        out += "&amp;";
        break;
      case '<':
        out += "&lt;";
        break;
      case '>':
        out += "&gt;";
        break;
      case '"':
        out += "&quot;";
        break;
      case '\'':
        out += "&#39;";
        break;
      default:
        out += c;
    }
  }
  return out;
}

Page::Section& Page::current() {
  if (sections_.empty()) section("found", "Found");
  return sections_.back();
}

void Page::section(const std::string& id, const std::string& title) {
  sections_.emplace_back().id = id;
  sections_.back().title = title;
}

void Page::finding(Finding finding) { current().findings.push_back(std::move(finding)); }
void Page::falls_short(const std::string& text) { current().shortfalls.push_back(text); }
void Page::method(const std::string& text) { current().method += paragraph_of(text); }
void Page::command(const std::string& line) {
  current().method += "<pre>" + escape_html(line) + "</pre>\n";
}

void Page::heading(const std::string& title) {
  current().body += "<h3>" + escape_html(title) + "</h3>\n";
}
void Page::paragraph(const std::string& text) { current().body += paragraph_of(text); }
void Page::list(const std::vector<std::string>& items) { current().body += list_of(items); }

void Page::figure(const std::string& svg, const std::string& caption) {
  current().body += "<figure class=\"plot\"><div>" + svg + "</div><figcaption>" +
                    escape_html(caption) + "</figcaption></figure>\n";
}

void Page::table(const Table& table, const std::vector<bool>& marked) {
  current().body += table_of(table, marked);
}

void Page::folded(const std::string& summary, const Table& table) {
  current().body += "<details><summary>" + escape_html(summary) + "</summary>\n" +
                    table_of(table, {}) + "</details>\n";
}

std::string Page::html(const std::string& title, const std::vector<std::string>& failed,
                       const std::vector<std::string>& origin) const {
  const auto answers = [](const Section& section) { return !section.findings.empty(); };
  // The figures of a page with one part stand at its head only.
  const bool one_part = std::count_if(sections_.begin(), sections_.end(), answers) == 1;
  std::string found, contents, body;
  for (const Section& section : sections_) {
    const std::string id = escape_html(section.id), name = escape_html(section.title);
    contents += "<li><a href=\"#" + id + "\">" + name + "</a></li>\n";
    body += "<section><h2 id=\"" + id + "\">" + name + "</h2>\n";
    std::string figures;
    for (const Finding& finding : section.findings) figures += card(finding, "");
    if (one_part) {
      found += figures;
    } else if (!section.findings.empty()) {
      found += card(section.findings.front(), section.id);
      body += "<ul class=\"findings\">\n" + figures + "</ul>\n";
    }
    body += shortfalls_of("Falls short", section.shortfalls) + section.body;
    if (!section.method.empty()) {
      body += "<details><summary>How it was measured</summary>\n" + section.method + "</details>\n";
    }
    body += "</section>\n";
  }
  std::string top = shortfalls_of("What must hold and does not", failed);
  if (!found.empty()) top += "<ul class=\"findings\">\n" + found + "</ul>\n";
  std::string end;
  for (const std::string& line : origin) end += paragraph_of(line);
  return "<!DOCTYPE html>\n<html lang=\"en\"><head><meta charset=\"utf-8\">"
         "<meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\n<title>" +
         escape_html(title) + "</title><style>" + kPageStyle + "</style></head><body>\n<h1>" +
         escape_html(title) + "</h1>\n" + top + "<nav><ul>\n" + contents + "</ul></nav>\n" + body +
         "<footer class=\"origin\">\n" + end + "</footer>\n<script>" + kPageScript +
         "</script></body></html>\n";
}

}  // namespace mirage
