#include "server/net/web_pages.h"

#include <openssl/evp.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <filesystem>
#include <fstream>
#include <sstream>

namespace mirage {
namespace {

namespace fs = std::filesystem;

constexpr std::uintmax_t kMostFileBytes = 64u << 20;

const char* type_of(const std::string& name) {
  static const std::map<std::string, const char*> types = {
      {".html", "text/html; charset=utf-8"},
      {".css", "text/css; charset=utf-8"},
      {".js", "text/javascript; charset=utf-8"},
      {".wasm", "application/wasm"},
      {".svg", "image/svg+xml"},
      {".png", "image/png"}};
  const auto at = types.find(fs::path(name).extension().string());
  return at != types.end() ? at->second : nullptr;
}

// True if a policy may name this host: it has the form that browsers send, and nothing that would
// end the directive.
bool plain_host(const std::string& host) {
  return !host.empty() && std::all_of(host.begin(), host.end(), [](unsigned char c) {
    return std::isalnum(c) || c == '.' || c == '-' || c == ':' || c == '[' || c == ']' || c == '_';
  });
}

std::string trimmed(const std::string& text) {
  const auto first = text.find_first_not_of(" \t");
  if (first == std::string::npos) return {};
  return text.substr(first, text.find_last_not_of(" \t") - first + 1);
}

// Returns what a policy calls the text between two tags of a page; empty: it has none.
// Source: W3C, Content Security Policy Level 3, section 2.3.1, hash-source.
std::string hash_between(const std::string& page, const std::string& begin,
                         const std::string& end) {
  const std::size_t at = page.find(begin), to = page.find(end, at);
  if (at == std::string::npos || to == std::string::npos) return {};
  const std::string text = page.substr(at + begin.size(), to - at - begin.size());
  std::array<unsigned char, 32> hash{};
  std::array<unsigned char, 45> coded{};  // 44 characters and a zero
  EVP_Digest(text.data(), text.size(), hash.data(), nullptr, EVP_sha256(), nullptr);
  EVP_EncodeBlock(coded.data(), hash.data(), static_cast<int>(hash.size()));
  return std::string(" 'sha256-").append(reinterpret_cast<const char*>(coded.data())) + "'";
}

}  // namespace

std::string address_of(const Called& called) {
  if (!plain_host(called.host)) return {};
  return (called.tls ? "https://" : "http://") + called.host;
}

std::string escaped(const std::string& text) {
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

bool accepts_encoding(const std::string& accepted, const std::string& encoding) {
  std::istringstream parts(accepted);
  for (std::string part; std::getline(parts, part, ',');) {
    const std::size_t semicolon = part.find(';');
    if (trimmed(part.substr(0, semicolon)) != encoding) continue;
    if (semicolon == std::string::npos) return true;
    const std::string weight = trimmed(part.substr(semicolon + 1));
    return weight.find_first_not_of("q=0.") != std::string::npos;
  }
  return false;
}

Result<WebPages> WebPages::read(const std::string& folder) {
  WebPages out;
  std::error_code failed;
  for (const auto& entry : fs::recursive_directory_iterator(folder, failed)) {
    if (!entry.is_regular_file(failed) || entry.file_size(failed) > kMostFileBytes) continue;
    std::string path = "/" + fs::relative(entry.path(), folder, failed).generic_string();
    WebFile file;
    for (const auto& [suffix, encoding] : {std::pair(".gz", "gzip"), std::pair(".br", "br")}) {
      if (entry.path().extension() != suffix) continue;
      path.resize(path.size() - 3);
      file.encoding = encoding;
    }
    const char* const type = type_of(path);
    if (!type) continue;
    std::ifstream stream(entry.path(), std::ios::binary);
    std::string bytes((std::istreambuf_iterator<char>(stream)), {});
    if (!stream) return make_error(ErrorId::kIo, "cannot read '" + entry.path().string() + "'");
    file.type = type;
    file.page = path == "/index.html";
    file.shared = !file.page && path.rfind('/') == 0;
    file.body = std::make_shared<const std::string>(std::move(bytes));
    out.files_[path][file.encoding] = std::move(file);
  }
  if (out.files_["/index.html"].count("") == 0) {
    return make_error(ErrorId::kIo, "there is no page in '" + folder + "': no index.html",
                      "scripts/web puts one into build/web/site");
  }
  auto& forms = out.files_["/index.html"];
  const std::string& text = *forms[""].body;
  for (auto& [encoding, file] : forms) {
    file.style_hash = hash_between(text, "<style>", "</style>");
    file.script_hash = hash_between(text, "<script>", "</script>");
  }
  return out;
}

const WebFile* WebPages::find(const std::string& path, const std::string& accepted) const {
  const auto at = files_.find(path == "/" ? "/index.html" : path);
  if (at == files_.end()) return nullptr;
  for (const char* encoding : {"br", "gzip"}) {
    const auto form = at->second.find(encoding);
    if (form != at->second.end() && accepts_encoding(accepted, encoding)) return &form->second;
  }
  const auto plain = at->second.find("");
  return plain != at->second.end() ? &plain->second : nullptr;
}

std::string WebPages::headers(const WebFile& file, const std::string& host,
                              const std::vector<std::string>& embed_origins) {
  std::string out =
      file.page ? "Vary: Accept-Encoding, User-Agent\r\n" : "Vary: Accept-Encoding\r\n";
  out += "X-Content-Type-Options: nosniff\r\n";
  out += file.page     ? "Cache-Control: no-cache\r\n"
         : file.shared ? "Cache-Control: public, max-age=3600\r\nAccess-Control-Allow-Origin: *\r\n"
                         "Cross-Origin-Resource-Policy: cross-origin\r\n"
                       : "Cache-Control: public, max-age=31536000, immutable\r\n";
  if (!file.encoding.empty()) out += "Content-Encoding: " + file.encoding + "\r\n";
  if (!file.page) return out;
  // Some browsers do not count a WebSocket of the same host as 'self'.
  const std::string sockets = plain_host(host) ? " ws://" + host + " wss://" + host : "";
  out += "Content-Security-Policy: default-src 'none'; script-src 'self' 'wasm-unsafe-eval'" +
         file.script_hash + "; worker-src 'self'; style-src 'self'" + file.style_hash +
         "; img-src 'self' data:; connect-src 'self'" + sockets +
         "; base-uri 'none'; form-action 'none'; frame-ancestors 'self'";
  for (const std::string& origin : embed_origins) out += " " + origin;
  out += "\r\n";
  out += "Referrer-Policy: no-referrer\r\nCross-Origin-Opener-Policy: same-origin\r\n";
  return out;
}

std::string web_folder_beside_program() {
  std::error_code failed;
  const fs::path self = fs::read_symlink("/proc/self/exe", failed);
  if (failed) return {};
  const fs::path above = self.parent_path().parent_path();
  // The first folder is that of an installation or a bundle, the second that of a build.
  for (const fs::path& folder : {above / "share/mirage/web", above.parent_path() / "web/site"}) {
    if (fs::exists(folder / "index.html", failed)) return folder.string();
  }
  return {};
}

}  // namespace mirage
