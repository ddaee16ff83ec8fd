#pragma once
// Command-line conventions of all programs: default < --config file < MIRAGE_… environment <
// command line; errors are one line on standard error; exit codes as in error.h.

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <sstream>
#include <string>

#include "protocol/error.h"

namespace mirage {

inline int fail(const Error& error) {
  std::fprintf(stderr, "%s\n", error.line().c_str());
  return static_cast<int>(exit_code(error.id));
}

/// A number within [low, high]; unlike CLI::Range it refuses NaN, too.
inline CLI::Validator number_within(double low, double high) {
  std::ostringstream range;
  range << low << " to " << high;
  return CLI::Validator(
      [low, high, range = range.str()](std::string& text) {
        char* end = nullptr;
        const double v = std::strtod(text.c_str(), &end);
        const bool good = !text.empty() && *end == '\0' && v >= low && v <= high;
        return good ? std::string() : "'" + text + "' is not a number from " + range;
      },
      "NUMBER from " + range.str());
}

/// Adds --version and --config, and an environment name for every option: MIRAGE_CACHE_MB for
/// --cache-mb.
inline void add_conventions(CLI::App& app) {
  app.set_version_flag("--version", "mirage " MIRAGE_VERSION);
  app.set_config("--config", "", "TOML file with option values");
  for (CLI::Option* option : app.get_options()) {
    if (option->get_lnames().empty()) continue;
    std::string name = "MIRAGE_" + option->get_lnames().front();
    std::transform(name.begin(), name.end(), name.begin(), [](unsigned char c) {
      return c == '-' ? '_' : static_cast<char>(std::toupper(c));
    });
    const bool special =
        name == "MIRAGE_HELP" || name == "MIRAGE_VERSION" || name == "MIRAGE_CONFIG";
    if (!special) option->envname(name);
  }
}

/// Parses; returns an exit code when the program is to end (help, version, usage error), else -1.
inline int parse_command_line(CLI::App& app, int argc, char** argv) {
  try {
    app.parse(argc, argv);
    return -1;
  } catch (const CLI::Success& success) {
    return app.exit(success);
  } catch (const CLI::ParseError& error) {
    return fail(
        make_error(ErrorId::kUsage, error.what(), app.get_name() + " --help lists the options"));
  }
}

}  // namespace mirage
