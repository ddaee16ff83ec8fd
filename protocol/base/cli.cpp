#include "protocol/base/cli.h"

#include <unistd.h>

#include <algorithm>
#include <cctype>
#include <cstdio>
#include <cstdlib>
#include <numeric>
#include <optional>
#include <sstream>

#include "protocol/base/cli_help.h"

namespace mirage {
namespace {

constexpr char kPrefix[] = "MIRAGE_";
// Variables of scripts, tests and `mirage-report fidelity`, which are no options.
const char* const kOtherVariables[] = {"MIRAGE_DEMO_BIN",          "MIRAGE_DEMO_FRAMES",
                                       "MIRAGE_DEMO_OUT",          "MIRAGE_SHARED",
                                       "MIRAGE_FIDELITY_PICTURES", "MIRAGE_SWEEP_VERBOSE"};

/// Number of letters to change to turn one text into the other (Levenshtein's distance).
std::size_t edits_between(const std::string& a, const std::string& b) {
  std::vector<std::size_t> row(b.size() + 1);
  std::iota(row.begin(), row.end(), std::size_t{0});
  for (std::size_t i = 1; i <= a.size(); ++i) {
    std::size_t diagonal = row[0];
    row[0] = i;
    for (std::size_t j = 1; j <= b.size(); ++j) {
      const std::size_t changed = diagonal + (a[i - 1] == b[j - 1] ? 0 : 1);
      diagonal = row[j];
      row[j] = std::min({row[j - 1] + 1, row[j] + 1, changed});
    }
  }
  return row.back();
}

/// Returns "did you mean …?" if `name` is nearly one of `known`, else `otherwise`.
std::string nearest_or(const std::string& name, const std::vector<std::string>& known,
                       const std::string& otherwise) {
  const auto distance = [&](const std::string& one) { return edits_between(name, one); };
  const auto best = std::min_element(known.begin(), known.end(), [&](const auto& a, const auto& b) {
    return distance(a) < distance(b);
  });
  if (best == known.end() || distance(*best) > std::max<std::size_t>(2, name.size() / 4)) {
    return otherwise;
  }
  return "did you mean " + *best + "?";
}

std::vector<std::string> long_names(const CLI::App& app) {
  std::vector<std::string> out;
  for (const CLI::Option* option : app.get_options()) {
    const std::vector<std::string>& names = option->get_lnames();
    out.insert(out.end(), names.begin(), names.end());
  }
  return out;
}

/// Returns an error for the first MIRAGE_… variable that no program reads.
std::optional<Error> unknown_variable() {
  for (char** at = environ; at && *at; ++at) {
    const std::string entry = *at;
    const std::string name = entry.substr(0, entry.find('='));
    if (name.rfind(kPrefix, 0) != 0) continue;
    std::vector<std::string> known(std::begin(kOtherVariables), std::end(kOtherVariables));
    for (const std::string& option : options_of_all_programs()) {
      known.push_back(environment_name(option));
    }
    if (std::find(known.begin(), known.end(), name) != known.end()) continue;
    return make_error(ErrorId::kUsage, "the environment has " + name + ", which no program reads",
                      nearest_or(name, known, "unset it, or see --help for the names"));
  }
  return std::nullopt;
}

Error in_config_file(const CLI::App& app, const std::string& key) {
  const std::size_t section = key.rfind(".++");  // CLI11's name for the start of a section
  if (section != std::string::npos) {
    return make_error(ErrorId::kUsage,
                      "the --config file has a section [" + key.substr(0, section) + "]",
                      "options stand in no section");
  }
  return make_error(ErrorId::kUsage,
                    "the --config file has '" + key + "', which is no option of " + app.get_name(),
                    nearest_or(key, long_names(app), app.get_name() + " --help lists the options"));
}

/// Returns the key of CLI11's error for an unknown key: "INI was not able to parse KEY".
std::optional<std::string> unknown_key(const CLI::ParseError& error) {
  const std::string text = error.what(), before = "INI was not able to parse ";
  if (error.get_name() != "ConfigError" || text.rfind(before, 0) != 0) return std::nullopt;
  return text.substr(before.size());
}

}  // namespace

const std::vector<std::string>& options_of_all_programs() {
  static const std::vector<std::string> names = {"admin",        "allow-origin",
                                                 "animate",      "animation",
                                                 "atlas-mb",     "box",
                                                 "cache-dir",    "cache-dir-mb",
                                                 "cache-mb",     "cache-read-only",
                                                 "check-config", "child",
                                                 "choices",      "clients",
                                                 "clip",         "codec",
                                                 "connect-rate", "connect-timeout",
                                                 "data",         "device",
                                                 "device-model", "doctor",
                                                 "downloads",    "drain-s",
                                                 "dry-run",      "duration",
                                                 "embed-origin", "encoders",
                                                 "environment",  "error",
                                                 "explain",      "explain-frame",
                                                 "eyes",         "folder",
                                                 "format",       "fov",
                                                 "fps",          "frame-ms",
                                                 "frames",       "gles",
                                                 "gpu-mb",       "grid",
                                                 "hours",        "home",
                                                 "jobs",         "json",
                                                 "key-file",     "layout",
                                                 "light",        "list",
                                                 "list-devices", "listen",
                                                 "log-format",   "look",
                                                 "maps",         "march-kpx",
                                                 "max-clients",  "mb",
                                                 "measure",      "mesh-mb",
                                                 "mesh-radii",   "method",
                                                 "metrics",      "model",
                                                 "msaa",         "name",
                                                 "net",          "no-downloads",
                                                 "no-geometry",  "no-reference",
                                                 "no-view",      "no-web",
                                                 "object",       "offscreen",
                                                 "only",         "out",
                                                 "page",         "path",
                                                 "port-file",    "prove",
                                                 "prove-cells",  "prove-objects",
                                                 "quick",        "rate",
                                                 "rate-mbps",    "reconnect",
                                                 "reference",    "reference-samples",
                                                 "references",   "relight",
                                                 "replace",      "require-gpu",
                                                 "samples",      "scene",
                                                 "scene-mb",     "scope",
                                                 "seconds",      "seed",
                                                 "shadows",      "shard",
                                                 "size",         "software",
                                                 "spread",       "stand-in-ms",
                                                 "stats",        "store",
                                                 "strict",       "supersample",
                                                 "target",       "tau",
                                                 "threads",      "tls-ca",
                                                 "tls-cert",     "tls-key",
                                                 "token-file",   "trace",
                                                 "trust-proxy",  "upload-kb",
                                                 "url",          "urls",
                                                 "variant",      "verify",
                                                 "virtual-time", "warm",
                                                 "warm-shard",   "web",
                                                 "whole",        "write-environment"};
  return names;
}

std::string environment_name(const std::string& option) {
  std::string name = kPrefix + option;
  std::transform(name.begin(), name.end(), name.begin(), [](unsigned char c) {
    return c == '-' ? '_' : static_cast<char>(std::toupper(c));
  });
  return name;
}

CLI::Validator number_within(double low, double high) {
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

void add_page(CLI::App& app, const std::string& flag, const std::string& description,
              std::function<std::string()> page) {
  const auto print = [page = std::move(page)](std::int64_t) {
    std::fputs(page().c_str(), stdout);
    throw CLI::Success();
  };
  app.add_flag_function(flag, print, description)->group(kCommonGroup);
}

void add_conventions(CLI::App& app) {
  for (CLI::Option* option : app.get_options()) {
    const bool named = !option->get_lnames().empty() && option->get_group() != kCommonGroup;
    if (!named || option == app.get_help_ptr()) continue;
    option->envname(environment_name(option->get_lnames().front()));
  }
  app.formatter(std::make_shared<HelpFormatter>());
  app.set_help_flag("-h,--help", "print this help and exit")->group(kCommonGroup);
  app.set_version_flag("--version", "mirage " MIRAGE_VERSION, "print the version and exit")
      ->group(kCommonGroup);
  app.set_config("--config", "", "TOML file with option values, such as cache-mb = 512")
      ->type_name("FILE")
      ->group(kCommonGroup);
  app.allow_config_extras(CLI::config_extras_mode::error);
  add_page(app, "--help-markdown", "print the options as a page of the reference and exit",
           [&app] { return options_page(app); });
  add_page(app, "--help-errors", "print every error id with cause and cure and exit", errors_text);
  add_page(app, "--help-exit-codes", "print exit and close code of every error id and exit",
           exit_codes_page);
}

int parse_command_line(CLI::App& app, int argc, char** argv) {
  try {
    app.parse(argc, argv);
  } catch (const CLI::Success& success) {
    return app.exit(success);
  } catch (const CLI::ParseError& error) {
    if (const std::optional<std::string> key = unknown_key(error)) {
      return fail(in_config_file(app, *key));
    }
    return fail(
        make_error(ErrorId::kUsage, error.what(), app.get_name() + " --help lists the options"));
  }
  if (const std::optional<Error> error = unknown_variable()) return fail(*error);
  return -1;
}

}  // namespace mirage
