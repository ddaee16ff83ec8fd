// mirage-token: makes a token that a server accepts for some hours, signed with a key of its token
// file.
#include <cmath>
#include <cstdio>
#include <ctime>
#include <fstream>
#include <sstream>

#include "protocol/base/cli.h"
#include "protocol/base/resources.h"
#include "server/session/access.h"

namespace mirage {
namespace {

int run(int argc, char** argv) {
  std::string key_file, name, path, scope = "view,geometry";
  double hours = 24;
  CLI::App app(
      "Makes a token that a server accepts for some hours, signed with a key of its token file.",
      "mirage-token");
  app.footer(
      "Example: mirage-token --key-file tokens --name anna --hours 8 > anna.token\n"
      "         mirage-view ws://box:9870 --token-file anna.token");
  app.option_defaults()->group("Token");
  app.add_option("--key-file", key_file,
                 "token file of the server; its first line key=SECRET signs")
      ->type_name("FILE")
      ->required();
  app.add_option("--name", name, "name of the person or machine: letters, digits, - and _")
      ->type_name("NAME");
  app.add_option("--hours", hours, "hours for which the token is valid")
      ->check(CLI::Range(0.01, 24.0 * 3660))
      ->capture_default_str();
  app.add_option("--scope", scope, "what the token allows: view[,geometry][,reference]")
      ->type_name("SCOPE")
      ->capture_default_str();
  app.add_option("--path", path,
                 "instead of a token, print a URL query that allows to get what lies below this "
                 "path, such as /v1/tile/REVISION/")
      ->type_name("PATH");
  add_conventions(app);
  if (const int code = parse_command_line(app, argc, argv); code >= 0) return code;
  if (name.empty() == path.empty()) {
    return fail(make_error(ErrorId::kUsage, "either --name, for a token, or --path"));
  }
  std::ifstream file(key_file);
  std::string key;
  for (std::string line; key.empty() && std::getline(file, line);) {
    std::istringstream words(line);
    std::string word;
    if (words >> word && word.rfind("key=", 0) == 0) key = word.substr(4);
  }
  if (key.empty()) {
    return fail(make_error(ErrorId::kUsage, "'" + key_file + "' has no line key=SECRET",
                           "openssl rand -hex 32 makes a good one"));
  }
  const auto expires_s = std::time(nullptr) + std::llround(3600 * hours);
  if (!path.empty()) {
    std::printf("until=%lld&signature=%s\n", static_cast<long long>(expires_s),
                path_signature(key, path, expires_s).c_str());
    return 0;
  }
  const Result<std::string> token = signed_token(key, name, expires_s, scope);
  if (!token) return fail(token.error());
  std::printf("%s\n", token->c_str());
  return 0;
}

}  // namespace
}  // namespace mirage

int main(int argc, char** argv) {
  return mirage::run_program([&] { return mirage::run(argc, argv); });
}
