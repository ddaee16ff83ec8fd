#pragma once
// Command-line conventions of all programs. Precedence: default < --config file < MIRAGE_…
// environment < command line. An error is one line on standard error; exit codes are those of
// error.h. An unknown name in a file or the environment is an error: a misspelt token file must not
// open a server.

#include <CLI/CLI.hpp>
#include <functional>
#include <string>
#include <vector>

#include "protocol/base/fail.h"

namespace mirage {

/// Returns a check for a number within [low, high]. Unlike CLI::Range it also refuses NaN.
CLI::Validator number_within(double low, double high);

/// The group of --help, --version, --config and what all programs have besides.
inline constexpr char kCommonGroup[] = "All programs";

/// Adds the options of kCommonGroup, the layout of --help, and an environment name for every
/// option: MIRAGE_CACHE_MB for --cache-mb. Call it once all options of the program are there.
void add_conventions(CLI::App& app);

/// Adds a flag that prints `page()` and ends the program with exit code 0.
void add_page(CLI::App& app, const std::string& flag, const std::string& description,
              std::function<std::string()> page);

/// Parses the command line. Returns an exit code if the program must end (help, version, usage
/// error), else -1.
int parse_command_line(CLI::App& app, int argc, char** argv);

/// Returns the options of all programs without dashes, in alphabetical order. The environment may
/// hold those of another program than the running one.
const std::vector<std::string>& options_of_all_programs();

/// Returns the environment name of an option: MIRAGE_CACHE_MB for cache-mb.
std::string environment_name(const std::string& option);

}  // namespace mirage
