#include "client/report/page.h"

#include <OpenImageIO/filesystem.h>
#include <OpenImageIO/imageio.h>
#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <cstdlib>

namespace mirage {
namespace {

constexpr const char* kStyle = R"css(
:root { color-scheme: light dark; --ink: #1b1f24; --paper: #ffffff; --faint: #6a737d;
  --line: #d0d7de; --mark: #fff3c4; --code: #f3f4f6; }
@media (prefers-color-scheme: dark) { :root { --ink: #e6e6e6; --paper: #15181c; --faint: #9aa4ae;
  --line: #3a414a; --mark: #4a4014; --code: #23272e; } }
body { font: 16px/1.5 system-ui, sans-serif; color: var(--ink); background: var(--paper);
  max-width: 1180px; margin: 2rem auto; padding: 0 1rem; }
h1, h2, h3 { line-height: 1.2; } h2 { margin-top: 3rem; border-bottom: 1px solid var(--line); }
p, li { max-width: 80ch; } nav { border: 1px solid var(--line); padding: .5rem 1.5rem; }
code, pre { background: var(--code); font-size: 90%; } pre { padding: .5rem; overflow-x: auto; }
figure { margin: 1rem 0; } figcaption { color: var(--faint); font-size: 90%; }
figure.plot > div { background: #fff; padding: .5rem; overflow-x: auto; }
figure.plot svg { max-width: 100%; height: auto; }
.wide { overflow-x: auto; } table { border-collapse: collapse; font-size: 85%; }
th, td { border-bottom: 1px solid var(--line); padding: .15rem .6rem; text-align: left; }
td.number { text-align: right; font-variant-numeric: tabular-nums; }
tr.marked td { background: var(--mark); }
.three { display: grid; grid-template-columns: repeat(3, 1fr); gap: 4px; }
.three img { width: 100%; image-rendering: auto; }
.strip { display: grid; grid-auto-flow: column; grid-auto-columns: 240px; gap: 4px;
  overflow-x: auto; font-size: 85%; } .strip img { width: 100%; display: block; }
)css";

bool is_number(const std::string& text) {
  if (text == "n/a" || text == "inf") return true;
  char* end = nullptr;
  std::strtod(text.c_str(), &end);
  return !text.empty() && *end == '\0';
}

Result<std::string> data_uri(const Picture& p, const std::vector<std::uint8_t>& rgba) {
  std::vector<std::uint8_t> rgb, file;
  for (std::size_t i = 0; i + 3 < rgba.size(); i += 4) {
    rgb.insert(rgb.end(), &rgba[i], &rgba[i] + 3);
  }
  OIIO::Filesystem::IOVecOutput proxy(file);
  const auto out = OIIO::ImageOutput::create("x.jpg", &proxy);
  OIIO::ImageSpec spec(p.width, p.height, 3, OIIO::TypeDesc::UINT8);
  spec.attribute("Compression", "jpeg:93");
  if (!out || !out->open("x.jpg", spec) || !out->write_image(OIIO::TypeDesc::UINT8, rgb.data()) ||
      !out->close()) {
    return make_error(ErrorId::kIo, "cannot encode a picture", out ? out->geterror() : "");
  }
  return "data:image/jpeg;base64," + base64(file);
}

std::vector<std::uint8_t> difference(const Picture& p) {
  std::vector<std::uint8_t> out(p.drawn.size(), 255);
  for (std::size_t i = 0; i < out.size(); ++i) {
    if (i % 4 == 3) continue;
    out[i] = static_cast<std::uint8_t>(std::min(255, 2 * std::abs(p.drawn[i] - p.truth[i])));
  }
  return out;
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

std::string base64(const std::vector<std::uint8_t>& bytes) {
  static const char digits[] = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string out;
  for (std::size_t i = 0; i < bytes.size(); i += 3) {
    const std::size_t n = std::min<std::size_t>(3, bytes.size() - i);
    std::uint32_t group = 0;
    for (std::size_t k = 0; k < 3; ++k) group = group << 8 | (k < n ? bytes[i + k] : 0u);
    for (std::size_t k = 0; k < 4; ++k) out += k <= n ? digits[group >> (18 - 6 * k) & 63] : '=';
  }
  return out;
}

void Page::section(const std::string& id, const std::string& title) {
  body_ += fmt::format("<h2 id=\"{}\">{}</h2>\n", escape_html(id), escape_html(title));
  contents_ +=
      fmt::format("<li><a href=\"#{}\">{}</a></li>\n", escape_html(id), escape_html(title));
}

void Page::heading(const std::string& title) { body_ += "<h3>" + escape_html(title) + "</h3>\n"; }
void Page::paragraph(const std::string& text) { body_ += "<p>" + escape_html(text) + "</p>\n"; }

void Page::list(const std::vector<std::string>& items) {
  body_ += "<ul>\n";
  for (const std::string& item : items) body_ += "<li>" + escape_html(item) + "</li>\n";
  body_ += "</ul>\n";
}

void Page::command(const std::string& line) { body_ += "<pre>" + escape_html(line) + "</pre>\n"; }

void Page::figure(const std::string& svg, const std::string& caption) {
  body_ += "<figure class=\"plot\"><div>" + svg + "</div><figcaption>" + escape_html(caption) +
           "</figcaption></figure>\n";
}

void Page::table(const Table& table, const std::vector<bool>& marked) {
  body_ += "<div class=\"wide\"><table>\n<tr>";
  for (const std::string& name : table.columns()) body_ += "<th>" + escape_html(name) + "</th>";
  body_ += "</tr>\n";
  for (std::size_t i = 0; i < table.rows().size(); ++i) {
    body_ += i < marked.size() && marked[i] ? "<tr class=\"marked\">" : "<tr>";
    for (const std::string& cell : table.rows()[i]) {
      body_ += (is_number(cell) ? "<td class=\"number\">" : "<td>") + escape_html(cell) + "</td>";
    }
    body_ += "</tr>\n";
  }
  body_ += "</table></div>\n";
}

void Page::folded(const std::string& summary, const Table& what) {
  body_ += "<details><summary>" + escape_html(summary) + "</summary>\n";
  table(what);
  body_ += "</details>\n";
}

Result<void> Page::pictures(const std::string& caption, const Picture& picture) {
  std::string images;
  const std::pair<const char*, std::vector<std::uint8_t>> three[] = {
      {"as drawn", picture.drawn},
      {"full render", picture.truth},
      {"difference", difference(picture)}};
  for (const auto& [what, rgba] : three) {
    const Result<std::string> uri = data_uri(picture, rgba);
    if (!uri) return uri.error();
    images += fmt::format("<img alt=\"{}: {}\" src=\"{}\">", escape_html(caption), what, *uri);
  }
  body_ += "<figure><div class=\"three\">" + images + "</div><figcaption>" + escape_html(caption) +
           "</figcaption></figure>\n";
  return {};
}

Result<void> Page::strip(const std::string& caption,
                         const std::vector<std::pair<std::string, Picture>>& pictures) {
  std::string columns;
  for (const auto& [label, picture] : pictures) {
    const Result<std::string> drawn = data_uri(picture, picture.drawn);
    if (!drawn) return drawn.error();
    const Result<std::string> truth = data_uri(picture, picture.truth);
    if (!truth) return truth.error();
    const std::string name = escape_html(label);
    columns += fmt::format(
        "<div>{0}<img alt=\"{0}, as drawn\" src=\"{1}\"><img alt=\"{0}, full render\" "
        "src=\"{2}\"></div>",
        name, *drawn, *truth);
  }
  body_ += "<figure><div class=\"strip\">" + columns + "</div><figcaption>" + escape_html(caption) +
           "</figcaption></figure>\n";
  return {};
}

std::string Page::html(const std::string& title, const std::vector<std::string>& summary) const {
  std::string top;
  for (const std::string& line : summary) top += "<p>" + escape_html(line) + "</p>\n";
  return "<!DOCTYPE html>\n<html lang=\"en\"><head><meta charset=\"utf-8\">"
         "<meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\n<title>" +
         escape_html(title) + "</title><style>" + kStyle + "</style></head><body>\n<h1>" +
         escape_html(title) + "</h1>\n" + top + "<nav><ul>\n" + contents_ + "</ul></nav>\n" +
         body_ + "</body></html>\n";
}

}  // namespace mirage
