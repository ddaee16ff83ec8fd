#include "protocol/base/cli_help.h"

#include <algorithm>
#include <functional>
#include <iterator>
#include <sstream>
#include <vector>

#include "protocol/base/cli.h"
#include "protocol/base/figures.h"

namespace mirage {
namespace {

constexpr std::size_t kColumns = 100;       // of a line of --help
constexpr std::size_t kMeaningColumn = 28;  // where the meaning of an option begins

using Options = std::vector<const CLI::Option*>;

/// The placeholder of an option's value: its own, such as FILE, or N for a number; empty for a
/// flag.
std::string type_of(const CLI::Option& option) {
  const std::string type = option.get_type_name();
  const std::size_t colon = type.find(':');
  const std::string name = type.substr(0, colon);
  if (option.get_items_expected_max() == 0) return "";
  const bool number = name == "UINT" || name == "INT" || name == "FLOAT";
  return number ? "N" : name;
}

/// "1 to 64" of CLI11's "INT:INT in [1 - 64]", "a, b" of "TEXT:{a,b}"; empty without a limit.
std::string limits_of(const CLI::Option& option) {
  const std::string type = option.get_type_name();
  const std::size_t colon = type.find(':');
  if (option.get_items_expected_max() == 0 || colon == std::string::npos) return "";
  std::string limits = type.substr(colon + 1);
  const std::size_t bracket = limits.find(" in [");
  if (bracket != std::string::npos) {
    limits = limits.substr(bracket + 5, limits.rfind(']') - bracket - 5);
    if (const std::size_t dash = limits.find(" - "); dash != std::string::npos) {
      limits.replace(dash, 3, " to ");
    }
  } else if (limits.rfind("NUMBER from ", 0) == 0) {
    limits = limits.substr(12);
  } else if (limits.front() == '{') {
    limits = limits.substr(1, limits.find('}') - 1);
    for (std::size_t at = 0; (at = limits.find(',', at)) != std::string::npos; at += 2) {
      limits.replace(at, 1, ", ");
    }
  } else {
    return "";
  }
  return limits;
}

std::string names_of(const CLI::Option& option) {
  const std::string names =
      option.get_positional() ? option.get_name(true) : option.get_name(false, true);
  return names.substr(0, names.find('{'));  // CLI11 adds the value that a flag sets
}

/// A text in lines of at most `width` columns; breaks at spaces and keeps line breaks.
std::vector<std::string> wrapped(const std::string& text, std::size_t width) {
  std::vector<std::string> lines;
  std::istringstream paragraphs(text);
  for (std::string paragraph; std::getline(paragraphs, paragraph);) {
    if (paragraph.size() <= width) {  // a line that fits keeps its spaces: it may be a table
      lines.push_back(paragraph);
      continue;
    }
    const std::size_t indent = std::min(paragraph.find_first_not_of(' '), paragraph.size());
    std::istringstream words(paragraph);
    std::string line(indent, ' ');
    for (std::string word; words >> word;) {
      const bool begun = line.find_first_not_of(' ') != std::string::npos;
      if (begun && line.size() + 1 + word.size() > width) {
        lines.push_back(line);
        line = std::string(indent > 0 ? indent + 2 : 0, ' ') + word;
      } else {
        line += (begun ? " " : "") + word;
      }
    }
    lines.push_back(line);
  }
  return lines;
}

/// Meaning, then range and default in brackets.
std::string meaning_of(const CLI::Option& option) {
  std::string facts = limits_of(option);
  const auto add = [&](const std::string& fact) { facts += (facts.empty() ? "" : "; ") + fact; };
  if (!option.get_default_str().empty()) add("default " + option.get_default_str());
  if (option.get_required()) add("required");
  return option.get_description() + (facts.empty() ? "" : " [" + facts + "]");
}

void print_option(std::ostream& out, const CLI::Option& option) {
  const std::string type = option.get_positional() ? "" : type_of(option);
  std::string head = "  " + names_of(option) + (type.empty() ? "" : " " + type);
  const std::vector<std::string> lines = wrapped(meaning_of(option), kColumns - kMeaningColumn);
  if (head.size() + 2 > kMeaningColumn) {
    out << head << '\n';
    head.clear();
  }
  for (const std::string& line : lines) {
    out << head << std::string(kMeaningColumn - head.size(), ' ') << line << '\n';
    head.clear();
  }
}

/// Groups in the order in which their first options were added; the program's own come first.
std::vector<std::pair<std::string, Options>> groups_of(const CLI::App& app) {
  std::vector<std::pair<std::string, Options>> groups;
  for (const CLI::Option* option : app.get_options()) {
    const std::string& name = option->get_group();
    if (name.empty() || option->get_positional()) continue;
    const auto at = std::find_if(groups.begin(), groups.end(),
                                 [&](const auto& group) { return group.first == name; });
    (at == groups.end() ? groups.emplace_back(name, Options{}) : *at).second.push_back(option);
  }
  const auto common = [](const auto& group) { return group.first == kCommonGroup; };
  const auto last = std::stable_partition(groups.begin(), groups.end(), std::not_fn(common));
  const auto page = [](const CLI::Option* o) { return o->get_name().rfind("--help-", 0) == 0; };
  for (auto group = last; group != groups.end(); ++group) {
    std::stable_partition(group->second.begin(), group->second.end(), std::not_fn(page));
  }
  return groups;
}

Options positionals_of(const CLI::App& app) {
  return app.get_options([](const CLI::Option* option) { return option->get_positional(); });
}

std::string usage_of(const CLI::App& app) {
  std::string usage = app.get_name() + " [OPTIONS]";
  for (const CLI::Option* option : positionals_of(app)) {
    const std::string name =
        option->get_name(true) + (option->get_items_expected_max() > 1 ? " …" : "");
    usage += option->get_required() ? " " + name : " [" + name + "]";
  }
  return usage;
}

}  // namespace

std::string HelpFormatter::make_help(const CLI::App* app, std::string /*name*/,
                                     CLI::AppFormatMode /*mode*/) const {
  std::ostringstream out;
  out << app->get_description() << "\n\nUsage: " << usage_of(*app) << '\n';
  const Options positionals = positionals_of(*app);
  for (const CLI::Option* option : positionals) print_option(out, *option);
  for (const auto& [name, options] : groups_of(*app)) {
    out << '\n' << name << ":\n";
    for (const CLI::Option* option : options) print_option(out, *option);
  }
  out << '\n';
  for (const std::string& line : wrapped(app->get_footer(), kColumns)) out << line << '\n';
  return out.str();
}

std::string options_page(const CLI::App& app) {
  std::ostringstream out;
  out << "# " << app.get_name() << "\n\n"
      << app.get_description() << "\n\n```\n"
      << usage_of(app) << "\n```\n\n";
  out << "An option is also read from the environment (`--two-words` from `MIRAGE_TWO_WORDS`) and "
         "from the file\nof `--config` (`two-words = …`). The command line overrides the "
         "environment, which overrides the file.\n";
  const auto table = [&out](const Options& options) {
    out << "| option | default | what it does |\n|---|---|---|\n";
    for (const CLI::Option* option : options) {
      const std::string type = option->get_positional() ? "" : type_of(*option);
      const std::string limits = limits_of(*option);
      const std::string shown = names_of(*option) + (type.empty() ? "" : " " + type);
      out << "| `" << markdown_cell(shown) << "` | "
          << (option->get_required() ? "required" : markdown_cell(option->get_default_str()))
          << " | " << markdown_cell(option->get_description())
          << (limits.empty() ? "" : " (" + markdown_cell(limits) + ")") << " |\n";
    }
  };
  if (const Options positionals = positionals_of(app); !positionals.empty()) {
    out << "\n## Arguments\n";
    table(positionals);
  }
  for (const auto& [name, options] : groups_of(app)) {
    out << "\n## " << name << '\n';
    table(options);
  }
  if (!app.get_footer().empty()) out << "\n## Notes\n```\n" << app.get_footer() << "\n```\n";
  return out.str();
}

namespace {

struct ErrorRow {
  const char *id, *cause, *cure;
  int close;
};

constexpr ErrorRow kErrorRows[] = {
#define MIRAGE_X(e, id, exit, close, cause, cure) {id, cause, cure, close},
    MIRAGE_ERRORS(MIRAGE_X)
#undef MIRAGE_X
};

int exit_code_of(std::size_t row) { return static_cast<int>(exit_code(static_cast<ErrorId>(row))); }

}  // namespace

std::string errors_text() {
  std::ostringstream out;
  for (const ErrorRow& row : kErrorRows) {
    out << "### " << row.id << "\n**Cause.** " << row.cause << "\n\n**Cure.** " << row.cure
        << "\n\n";
  }
  return out.str();
}

std::string exit_codes_page() {
  std::ostringstream out;
  out << "# Exit codes and error ids\n\n"
         "An error is one line on standard error: `error ID: TEXT (hint: …)`. Scripts should look "
         "at the id: it stays, the\ntext may change.\n\n"
         "| exit code | meaning |\n|---|---|\n"
         "| 0 | All went well. |\n| 1 | An internal error, or a file that could not be read or "
         "written. |\n| 2 | Wrong use: options, configuration file, environment. |\n"
         "| 3 | The scene cannot be opened. |\n| 4 | Graphics: there is no device, or it failed; "
         "or a limit left too few threads or too little memory. "
         "|\n| 5 | Network: no connection, or it was refused or ended. |\n"
         "| 6 | A comparison or check failed. |\n\n"
         "| error id | exit code | close code of the WebSocket |\n|---|---|---|\n";
  for (std::size_t i = 0; i < std::size(kErrorRows); ++i) {
    const std::string id = kErrorRows[i].id;
    out << "| [" << id << "](../guide/troubleshooting.md#" << id << ") | " << exit_code_of(i)
        << " | " << kErrorRows[i].close << " |\n";
  }
  return out.str();
}

}  // namespace mirage
