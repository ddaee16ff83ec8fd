#pragma once
// Command-line conventions of all programs: default < --config file < MIRAGE_… environment <
// command line; errors are one line on standard error; exit codes as in error.h. What no program
// has, in a file or the environment, is an error: a misspelt token file must not open a server.

#include <CLI/CLI.hpp>
#include <string>

#include "protocol/base/fail.h"

namespace mirage {

/// A number within [low, high]; unlike CLI::Range it refuses NaN, too.
CLI::Validator number_within(double low, double high);

/// Adds --version and --config, and an environment name for every option: MIRAGE_CACHE_MB for
/// --cache-mb.
void add_conventions(CLI::App& app);

/// Parses; returns an exit code when the program is to end (help, version, usage error), else -1.
int parse_command_line(CLI::App& app, int argc, char** argv);

/// The options of all programs, without dashes before them, in order of the alphabet: what the
/// environment may hold for another program than the one that runs.
const std::vector<std::string>& options_of_all_programs();

/// MIRAGE_CACHE_MB for cache-mb.
std::string environment_name(const std::string& option);

}  // namespace mirage
