#pragma once
// Access rights of clients. A token file lists tokens, each with a name, an expiry time and a
// scope. It may also hold keys: whoever has a key can sign a token of limited duration without
// changing the file.
//
// The file has one entry a line; # begins a comment:
//   TOKEN [name=NAME] [expires=2027-01-31T12:00:00Z] [scope=view,geometry,reference]
//   key=SECRET
// A signed token is m1.NAME.EXPIRES.SCOPE.SIGNATURE: seconds since 1970, scopes joined by +, and
// the HMAC-SHA-256 of the text before the signature, in hexadecimal (RFC 2104).

#include <cstdint>
#include <string>
#include <vector>

#include "protocol/base/result.h"

namespace mirage {

/// Rights of a client beyond tiles and views.
struct Grant {
  std::string name;
  std::int64_t expires_s = INT64_MAX;  ///< seconds since 1970
  bool geometry = true;
  bool reference = true;
};

class Access {
 public:
  /// Access without tokens: everybody may do everything.
  Access() = default;
  /// Reads a token file. Error kUsage: it cannot be read, has no token, or has an invalid line,
  /// which the error names.
  static Result<Access> read(const std::string& path);
  /// Parses the text of such a file. Error kUsage.
  static Result<Access> parse(const std::string& text);

  /// One line for each token that is short enough to be guessed.
  const std::vector<std::string>& warnings() const { return warnings_; }
  bool open() const { return tokens_.empty() && keys_.empty(); }
  /// Checks a token in constant time. Error kAuth, with the same text for every wrong token except
  /// for an expired one.
  Result<Grant> check(const std::string& token, std::int64_t now_s) const;
  /// Checks a path signed by path_signature() and its expiry time. Error kAuth.
  Result<void> check_path(const std::string& path, std::int64_t until_s,
                          const std::string& signature, std::int64_t now_s) const;

 private:
  struct Token {
    std::string digest;  ///< SHA-256
    Grant grant;
  };
  Result<void> add_line(const std::string& line);
  std::vector<Token> tokens_;
  std::vector<std::string> keys_;
  std::vector<std::string> warnings_;
};

/// Returns a signed token. `scope` is written as in the file, joined by commas. Error kUsage: the
/// name has other characters than letters, digits, - and _, or a scope is unknown.
Result<std::string> signed_token(const std::string& key, const std::string& name,
                                 std::int64_t expires_s, const std::string& scope);
/// Returns the HMAC-SHA-256 in hexadecimal of `PATH?until=SECONDS`. Its holder may get the resource
/// at that path.
std::string path_signature(const std::string& key, const std::string& path, std::int64_t until_s);
/// Converts `2027-01-31T12:00:00Z` into seconds since 1970. Error kUsage.
Result<std::int64_t> parse_time(const std::string& text);

}  // namespace mirage
