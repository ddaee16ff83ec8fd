#pragma once
// Programs describe themselves here: --help for people, and the pages of docs/reference, which
// are written by the programs so that they cannot fall behind.

#include <CLI/CLI.hpp>
#include <string>

namespace mirage {

/// --help: description, usage, options by group in the order in which they were added, notes.
/// Lines have at most 100 columns.
class HelpFormatter : public CLI::FormatterBase {
 public:
  std::string make_help(const CLI::App* app, std::string name,
                        CLI::AppFormatMode mode) const override;
};

/// The options of a program as a Markdown page: a table for each group.
std::string options_page(const CLI::App& app);

/// Every error id with cause and cure, as the last part of the page about troubleshooting.
std::string errors_text();

/// Exit codes, and the exit and close code of every error id, as a Markdown page.
std::string exit_codes_page();

}  // namespace mirage
