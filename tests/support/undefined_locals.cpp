#include "tests/support/undefined_locals.h"

#include <cctype>
#include <regex>
#include <set>
#include <sstream>
#include <vector>

namespace mirage::test {
namespace {

std::string trimmed(const std::string& text) {
  const std::size_t first = text.find_first_not_of(" \t\n"), last = text.find_last_not_of(" \t\n");
  return first == std::string::npos ? "" : text.substr(first, last - first + 1);
}

// Resolves #if, #ifdef, #elif, #else by the macros that the text itself defines.
class Conditionals {
 public:
  std::string resolve(const std::string& source) {
    std::string out;
    std::istringstream lines(source);
    for (std::string line; std::getline(lines, line);) {
      line = line.substr(0, line.find("//"));
      if (!directive(trimmed(line)) && taken()) out += line + "\n";
    }
    return out;
  }

 private:
  struct Level {
    bool now = false;   // lines are taken
    bool done = false;  // a branch was taken
  };

  // Returns true if the line is a conditional.
  bool directive(const std::string& line) {
    std::smatch m;
    static const std::regex kForm("#\\s*(ifdef|ifndef|if|elif|else|endif|define)\\b\\s*(.*)");
    if (!std::regex_match(line, m, kForm)) return false;
    const std::string name = m[1], rest = m[2];
    if (name == "define") {
      if (taken()) defined_.insert(rest.substr(0, rest.find_first_of(" (\t")));
      return false;
    }
    if (name == "endif") {
      levels_.pop_back();
    } else if (name == "else" || name == "elif") {
      Level& level = levels_.back();
      level.now = !level.done && (name == "else" || holds(rest));
      level.done = level.done || level.now;
    } else {
      const bool is = name == "ifdef"    ? defined_.count(rest) != 0
                      : name == "ifndef" ? defined_.count(rest) == 0
                                         : holds(rest);
      levels_.push_back({is, is});
    }
    return true;
  }

  // `||` of `&&` of defined(NAME) and !defined(NAME): all that our shaders use.
  bool holds(const std::string& expression) const {
    static const std::regex kTerm("(!?)\\s*defined\\((\\w+)\\)");
    std::istringstream any(std::regex_replace(expression, std::regex("\\|\\|"), "\n"));
    for (std::string all; std::getline(any, all);) {
      bool every = true;
      for (std::sregex_iterator m(all.begin(), all.end(), kTerm), end; m != end; ++m) {
        every = every && (defined_.count((*m)[2]) != 0) == ((*m)[1] == "");
      }
      if (every) return true;
    }
    return false;
  }

  bool taken() const {
    for (const Level& level : levels_) {
      if (!level.now) return false;
    }
    return true;
  }

  std::set<std::string> defined_;
  std::vector<Level> levels_;
};

// Goes through the statements of a text without conditionals and comments.
class Locals {
 public:
  explicit Locals(Undefined value) : nan_(value == Undefined::kNan) {}

  std::string rewrite(const std::string& text) {
    text_ = text;
    int parentheses = 0;
    for (const char c : text) {
      if (c == '\n' && trimmed(statement_).rfind('#', 0) == 0) {  // a directive is one line
        out_ += statement_ + "\n";
        statement_.clear();
        continue;
      }
      parentheses += c == '(' ? 1 : c == ')' ? -1 : 0;
      if (parentheses > 0 || (c != ';' && c != '{' && c != '}')) {
        statement_ += c;
        continue;
      }
      if (c == ';') end_statement();
      if (c == '{') begin_block();
      if (c == '}') end_block();
      statement_.clear();
    }
    return out_ + statement_;
  }

 private:
  static constexpr const char* kTypes =
      "float|vec[234]|u?int|[ui]vec[234]|bool|bvec[234]|mat[234](?:x[234])?";

  std::string types() const {
    std::string all = kTypes;
    for (const std::string& name : structs_) all += "|" + name;
    return all;
  }

  std::string initial(const std::string& type) const {
    if (structs_.count(type) != 0) return "undefined_" + type + "()";
    if (type[0] == 'b') return type + (nan_ ? "(true)" : "(false)");
    if (type[0] == 'u' || type[0] == 'i') return type + (nan_ ? "(1431655765)" : "(0)");
    return type + (nan_ ? "(uintBitsToFloat(0x7fc00000u))" : "(0.0)");
  }

  void begin_block() {
    std::smatch m;
    const std::string head = trimmed(statement_);
    if (std::regex_match(head, m, std::regex("struct (\\w+)"))) struct_ = m[1];
    out_ += statement_ + "{";
    if (depth_++ > 0 || !struct_.empty()) return;
    static const std::regex kOut("\\b(?:out)\\s+(?:highp\\s+)?(\\w+)\\s+(\\w+)\\b");
    const std::size_t open = head.find('(');
    if (open == std::string::npos) return;
    for (std::sregex_iterator p(head.begin(), head.end(), kOut), end; p != end; ++p) {
      out_ += " " + (*p)[2].str() + " = " + initial((*p)[1]) + ";";
    }
    if (!std::regex_search(head, std::regex("\\bmain\\s*\\("))) return;
    if (text_.find("gl_Position") != std::string::npos) {
      out_ += " gl_Position = " + initial("vec4") + ";";
    }
    if (text_.find("gl_FragDepth =") != std::string::npos) {
      out_ += " gl_FragDepth = " + initial("float") + ";";
    }
    out_ += outputs_;
  }

  void end_block() {
    out_ += statement_ + "}";
    --depth_;
    if (depth_ > 0 || struct_.empty()) return;
    after_struct_ =
        struct_ + " undefined_" + struct_ + "() { " + struct_ + " s;" + members_ + " return s; }\n";
    structs_.insert(struct_);
    struct_.clear();
    members_.clear();
  }

  void end_statement() {
    std::smatch m;
    const std::string line = trimmed(statement_);
    static const std::regex kOutput(
        "(?:precise )?(?:layout\\([^)]*\\) )?(?:flat )?out (?:highp )?(\\w+) (\\w+)");
    const std::regex local("(?:highp )?(" + types() + ")\\s+([\\s\\S]*)");
    const bool declares = std::regex_match(line, m, local);
    if (declares && !struct_.empty()) {
      for (const std::string& name : declarators(m[2])) {
        members_ += " s." + name + " = " + initial(m[1]) + ";";
      }
    } else if (declares && depth_ > 0) {
      statement_ = "\n" + m[1].str() + " ";
      std::string comma;
      for (const std::string& one : declarators(m[2])) {
        statement_ += comma + one;
        if (one.find('=') == std::string::npos) statement_ += " = " + initial(m[1]);
        comma = ", ";
      }
    } else if (depth_ == 0 && std::regex_match(line, m, kOutput)) {
      outputs_ += " " + m[2].str() + " = " + initial(m[1]) + ";";
    }
    out_ += statement_ + ";";
    out_ += after_struct_.empty() ? "" : "\n" + after_struct_;
    after_struct_.clear();
  }

  // Splits at commas outside of parentheses.
  static std::vector<std::string> declarators(const std::string& text) {
    std::vector<std::string> out(1);
    int parentheses = 0;
    for (const char c : text) {
      parentheses += c == '(' ? 1 : c == ')' ? -1 : 0;
      if (c == ',' && parentheses == 0) {
        out.emplace_back();
      } else {
        out.back() += c;
      }
    }
    for (std::string& one : out) one = trimmed(one);
    return out;
  }

  bool nan_;
  int depth_ = 0;
  std::string text_, out_, statement_, struct_, members_, after_struct_, outputs_;
  std::set<std::string> structs_;
};

}  // namespace

std::string with_defined_locals(const std::string& source, Undefined value) {
  return Locals(value).rewrite(Conditionals().resolve(source));
}

}  // namespace mirage::test
