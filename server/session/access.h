#pragma once
// Who may be a client, and what for: tokens of a file, each with a name, a time it ends and a
// scope; and tokens that are signed with a key of that file, so that whoever has the key can make
// one for a while without the server being told.
//
// The file, a line each; # begins a comment:
//   TOKEN [name=NAME] [expires=2027-01-31T12:00:00Z] [scope=view,geometry,reference]
//   key=SECRET
// A signed token is m1.NAME.EXPIRES.SCOPE.SIGNATURE: seconds since 1970, scopes joined by +, and
// HMAC-SHA-256 in hexadecimal of what is before it (RFC 2104).

#include <cstdint>
#include <string>
#include <vector>

#include "protocol/base/result.h"

namespace mirage {

/// What a client may ask for beside tiles and views.
struct Grant {
  std::string name;
  std::int64_t expires_s = INT64_MAX;  ///< since 1970
  bool geometry = true;
  bool reference = true;
};

class Access {
 public:
  /// Without tokens everybody may do everything.
  Access() = default;
  /// Error kUsage: the file cannot be read, has no token, or a line that is none; it names the
  /// line.
  static Result<Access> read(const std::string& path);
  /// The same of such a file's text. Error kUsage.
  static Result<Access> parse(const std::string& text);

  bool open() const { return tokens_.empty() && keys_.empty(); }
  /// Takes as long whatever the token is. Error kAuth, the same for every wrong token but one
  /// that was right once.
  Result<Grant> check(const std::string& token, std::int64_t now_s) const;
  /// Of a path that is signed until then, as path_signature() does. Error kAuth.
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
};

/// A token that is signed. `scope` as in the file, joined by commas. Errors kUsage: a name with
/// other characters than letters, digits, - and _, or no such scope.
Result<std::string> signed_token(const std::string& key, const std::string& name,
                                 std::int64_t expires_s, const std::string& scope);
/// HMAC-SHA-256 in hexadecimal of `PATH?until=SECONDS`: whoever has it may get what lies there.
std::string path_signature(const std::string& key, const std::string& path, std::int64_t until_s);
/// `2027-01-31T12:00:00Z` as seconds since 1970. Error kUsage.
Result<std::int64_t> parse_time(const std::string& text);

}  // namespace mirage
