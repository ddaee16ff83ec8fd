#include "server/net/oembed.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <nlohmann/json.hpp>

#include "server/net/picture_http.h"
#include "server/net/web_pages.h"

namespace mirage {
namespace {

constexpr int kFrameWidth = 640, kFrameHeight = 360;  // of the frame, unless the request wants less
constexpr std::size_t kMostAddress = 2000;

/// Values of a request.
struct Wanted {
  std::string url, format = "json";
  int most_width = kFrameWidth, most_height = kFrameHeight;
};

bool read_size(const std::string& text, int& out) {
  const char* const end = text.data() + text.size();
  const auto [rest, error] = std::from_chars(text.data(), end, out);
  return error == std::errc() && rest == end && out >= 1;
}

/// Reads a query. Returns what is wrong with it; empty: nothing. The link's own `&` arrive decoded,
/// so names that oEmbed does not have are parts of the link.
std::string read(const std::string& query, Wanted& out) {
  for (const auto& [name, value] : query_values(query)) {
    if (name == "maxwidth" || name == "maxheight") {
      int& most = name == "maxwidth" ? out.most_width : out.most_height;
      int asked = 0;
      if (!read_size(value, asked)) return name + " is not a number of pixels";
      most = std::min(most, asked);
    } else if (name == "format") {
      out.format = value;
    } else if (name == "url") {
      out.url = value;
    } else if (!out.url.empty()) {
      out.url += "&" + name + "=" + value;
    }
  }
  if (out.url.empty()) return "url is missing: the address of a view of this server";
  return out.url.size() > kMostAddress ? "url is too long" : "";
}

/// True if an address has no character that browsers would escape.
bool plain_address(const std::string& text) {
  return std::all_of(text.begin(), text.end(), [](unsigned char c) {
    return std::isalnum(c) ||
           std::string_view("-._~:/?#[]@!$&()*+,;=%").find(static_cast<char>(c)) !=
               std::string_view::npos;
  });
}

/// Returns the values of the link's view that pictures have, to be appended to a query.
std::string view_of(const std::string& url) {
  const std::size_t hash = url.find('#');
  if (hash == std::string::npos) return {};
  std::string out;
  for (const auto& [name, value] : query_values(url.substr(hash + 1))) {
    if (name == "eye" || name == "look" || name == "light" || name == "fov") {
      out += "&" + name + "=" + value;
    }
  }
  return out;
}

}  // namespace

std::string oembed_address(const std::string& address) {
  std::string url;
  for (const char c : address) url += c == ':' ? "%3A" : c == '/' ? "%2F" : std::string(1, c);
  return fmt::format("{}{}?format=json&url={}%2F", address, kOembedPath, url);
}

HttpAnswer oembed_answer(const std::string& query, const std::string& address) {
  Wanted wanted;
  const std::string wrong = read(query, wanted);
  if (!wrong.empty()) return refusal(400, wrong);
  if (wanted.format != "json") return refusal(501, "format is json here");
  if (wanted.url.rfind(address + "/", 0) != 0 || !plain_address(wanted.url)) {
    return refusal(404, "url is no view of this server: its views begin with " + address + "/");
  }
  const int width =
      std::max(1, std::min(wanted.most_width, wanted.most_height * kFrameWidth / kFrameHeight));
  const int height = std::max(1, width * kFrameHeight / kFrameWidth);
  const std::string view = view_of(wanted.url);
  const nlohmann::json out = {
      {"version", "1.0"},
      {"type", "rich"},
      {"title", kPageTitle},
      {"provider_name", "Mirage"},
      {"provider_url", address + "/"},
      {"width", width},
      {"height", height},
      {"html", fmt::format(R"(<iframe src="{}" width="{}" height="{}" title="{}" )"
                           R"(allowfullscreen style="border:0"></iframe>)",
                           escaped(wanted.url), width, height, kPageTitle)},
      {"thumbnail_url",
       fmt::format("{}{}?size={}x{}&format=jpeg{}", address, kPicturePath, width, height, view)},
      {"thumbnail_width", width},
      {"thumbnail_height", height}};
  return {200, "application/json", "Access-Control-Allow-Origin: *\r\nCache-Control: no-cache\r\n",
          out.dump() + "\n"};
}

}  // namespace mirage
