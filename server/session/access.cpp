#include "server/session/access.h"

#include <openssl/crypto.h>
#include <openssl/evp.h>
#include <openssl/hmac.h>

#include <algorithm>
#include <charconv>
#include <ctime>
#include <fstream>
#include <sstream>

namespace mirage {
namespace {

constexpr std::size_t kUnguessable = 16;  // characters

constexpr std::size_t kMostNameBytes = 64;
const char* const kSignedPrefix = "m1.";

std::string digest_of(const std::string& text) {
  unsigned char out[EVP_MAX_MD_SIZE];
  unsigned int size = 0;
  EVP_Digest(text.data(), text.size(), out, &size, EVP_sha256(), nullptr);
  return {reinterpret_cast<const char*>(out), size};
}

std::string signature_of(const std::string& key, const std::string& text) {
  unsigned char out[EVP_MAX_MD_SIZE];
  unsigned int size = 0;
  HMAC(EVP_sha256(), key.data(), static_cast<int>(key.size()),
       reinterpret_cast<const unsigned char*>(text.data()), text.size(), out, &size);
  std::string hex;
  for (unsigned int i = 0; i < size; ++i) {
    hex += "0123456789abcdef"[out[i] >> 4];
    hex += "0123456789abcdef"[out[i] & 15];
  }
  return hex;
}

bool same(const std::string& a, const std::string& b) {
  return a.size() == b.size() && CRYPTO_memcmp(a.data(), b.data(), a.size()) == 0;
}

std::vector<std::string> split(const std::string& text, char at) {
  std::vector<std::string> out;
  std::istringstream in(text);
  for (std::string part; std::getline(in, part, at);) out.push_back(part);
  return out;
}

bool valid_name(const std::string& name) {
  return !name.empty() && name.size() <= kMostNameBytes &&
         std::all_of(name.begin(), name.end(),
                     [](unsigned char c) { return std::isalnum(c) != 0 || c == '-' || c == '_'; });
}

// Sets the scopes of a grant; false if a scope is unknown.
bool set_scope(const std::vector<std::string>& scopes, Grant& grant) {
  grant.geometry = grant.reference = false;
  bool view = false;
  for (const std::string& scope : scopes) {
    if (scope == "view") {
      view = true;
    } else if (scope == "geometry") {
      grant.geometry = true;
    } else if (scope == "reference") {
      grant.reference = true;
    } else {
      return false;
    }
  }
  return view;
}

Error wrong_token() { return {ErrorId::kAuth, "wrong or missing token", ""}; }

}  // namespace

Result<std::int64_t> parse_time(const std::string& text) {
  std::tm t{};
  const char* const end = strptime(text.c_str(), "%Y-%m-%dT%H:%M:%SZ", &t);
  if (!end || *end != '\0') {
    return make_error(ErrorId::kUsage, "'" + text + "' is no time like 2027-01-31T12:00:00Z");
  }
  return static_cast<std::int64_t>(timegm(&t));
}

Result<void> Access::add_line(const std::string& line) {
  const auto wrong = [](const std::string& what) { return make_error(ErrorId::kUsage, what); };
  std::istringstream words(line.substr(0, line.find('#')));
  std::string secret;
  if (!(words >> secret)) return {};
  if (secret.rfind("key=", 0) == 0) {
    if (secret.size() < 4 + kUnguessable) return wrong("a key has at least 16 characters");
    keys_.emplace_back(secret, 4);
    return {};
  }
  Token token;
  token.digest = digest_of(secret);
  token.grant.name = "token " + std::to_string(tokens_.size() + 1);
  for (std::string word; words >> word;) {
    const std::size_t is = word.find('=');
    const std::string key = word.substr(0, is);
    const std::string value = is == std::string::npos ? "" : word.substr(is + 1);
    if (key == "name" && valid_name(value)) {
      token.grant.name = value;
    } else if (key == "expires") {
      const Result<std::int64_t> time = parse_time(value);
      if (!time) return time.error();
      token.grant.expires_s = *time;
    } else if (key != "scope" || !set_scope(split(value, ','), token.grant)) {
      return wrong("'" + word + "' is no name=, expires= or scope=view[,geometry][,reference]");
    }
  }
  if (secret.size() < kUnguessable) {
    warnings_.push_back("the token of '" + token.grant.name + "' has " +
                        std::to_string(secret.size()) + " characters: fewer than " +
                        std::to_string(kUnguessable) +
                        " can be guessed ('openssl rand -hex 16' makes one)");
  }
  tokens_.push_back(std::move(token));
  return {};
}

Result<Access> Access::parse(const std::string& text) {
  Access out;
  std::size_t number = 0;
  std::istringstream lines(text);
  for (std::string line; std::getline(lines, line);) {
    ++number;
    if (const Result<void> added = out.add_line(line); !added) {
      return make_error(ErrorId::kUsage,
                        "line " + std::to_string(number) + ": " + added.error().text);
    }
  }
  if (out.open()) return make_error(ErrorId::kUsage, "there is no token in it");
  return out;
}

Result<Access> Access::read(const std::string& path) {
  std::ifstream file(path);
  if (!file) return make_error(ErrorId::kUsage, "token file '" + path + "' cannot be read");
  std::ostringstream text;
  text << file.rdbuf();
  Result<Access> out = parse(text.str());
  if (out) return out;
  return make_error(ErrorId::kUsage, "token file '" + path + "': " + out.error().text);
}

Result<Grant> Access::check(const std::string& token, std::int64_t now_s) const {
  if (open()) return Grant{};
  const std::string digest = digest_of(token);
  const Grant* known = nullptr;
  for (const Token& one : tokens_) {  // checks all of them, so that the time tells nothing
    if (same(one.digest, digest)) known = &one.grant;
  }
  Grant grant;
  bool right = known != nullptr;
  if (known) grant = *known;
  const std::size_t dot = token.rfind('.');
  if (!right && token.rfind(kSignedPrefix, 0) == 0 && dot != std::string::npos) {
    const std::string text = token.substr(0, dot), signature = token.substr(dot + 1);
    bool signed_here = false;
    for (const std::string& key : keys_) {
      signed_here = same(signature_of(key, text), signature) || signed_here;
    }
    const std::vector<std::string> parts = split(text, '.');
    if (!signed_here || parts.size() != 4 || !set_scope(split(parts[3], '+'), grant)) {
      return wrong_token();
    }
    const std::string& expires = parts[2];
    const auto read =
        std::from_chars(expires.data(), expires.data() + expires.size(), grant.expires_s);
    if (read.ec != std::errc() || read.ptr != expires.data() + expires.size()) {
      return wrong_token();
    }
    grant.name = parts[1];
    right = true;
  }
  if (!right) return wrong_token();
  if (now_s >= grant.expires_s) return make_error(ErrorId::kAuth, "the token has expired");
  return grant;
}

std::string path_signature(const std::string& key, const std::string& path, std::int64_t until_s) {
  return signature_of(key, path + "?until=" + std::to_string(until_s));
}

Result<void> Access::check_path(const std::string& path, std::int64_t until_s,
                                const std::string& signature, std::int64_t now_s) const {
  bool right = open();
  for (const std::string& key : keys_) {
    right = same(path_signature(key, path, until_s), signature) || right;
  }
  if (!right) return make_error(ErrorId::kAuth, "neither a right token nor a right signature");
  if (!open() && now_s >= until_s) return make_error(ErrorId::kAuth, "the signature has expired");
  return {};
}

Result<std::string> signed_token(const std::string& key, const std::string& name,
                                 std::int64_t expires_s, const std::string& scope) {
  Grant grant;
  if (!valid_name(name)) {
    return make_error(ErrorId::kUsage, "a name has letters, digits, - and _, 64 at most");
  }
  if (!set_scope(split(scope, ','), grant)) {
    return make_error(ErrorId::kUsage, "scope is view, with ,geometry or ,reference behind it");
  }
  std::string joined = scope;
  std::replace(joined.begin(), joined.end(), ',', '+');
  const std::string text = kSignedPrefix + name + "." + std::to_string(expires_s) + "." + joined;
  return text + "." + signature_of(key, text);
}

}  // namespace mirage
