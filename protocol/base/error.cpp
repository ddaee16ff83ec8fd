#include "protocol/base/error.h"

namespace mirage {
namespace {

struct Row {
  std::string_view name;
  ExitCode exit;
  int close;
};

constexpr Row kRows[] = {
#define MIRAGE_X(e, id, exit, close, cause, cure) {id, ExitCode::exit, close},
    MIRAGE_ERRORS(MIRAGE_X)
#undef MIRAGE_X
};

const Row& row(ErrorId id) { return kRows[static_cast<int>(id)]; }

/// Control characters (a newline in a file name, say) must not break the one-line promise.
std::string single_line(const std::string& text) {
  std::string out = text;
  for (char& c : out) {
    if (static_cast<unsigned char>(c) < 0x20 || c == 0x7f) c = ' ';
  }
  return out;
}

}  // namespace

std::string_view error_name(ErrorId id) { return row(id).name; }
ExitCode exit_code(ErrorId id) { return row(id).exit; }
int close_code(ErrorId id) { return row(id).close; }

std::string Error::line() const {
  std::string out = "error " + std::string(error_name(id)) + ": " + single_line(text);
  if (!hint.empty()) out += " (hint: " + single_line(hint) + ")";
  return out;
}

}  // namespace mirage
