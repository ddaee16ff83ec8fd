#pragma once
// Extreme case: a stiff or extreme case (numerics.md section 6). It has the input of the shipped
// code, what must hold, and a function that feeds the input and measures.

#include <cstdint>
#include <string>
#include <variant>
#include <vector>

namespace mirage::extreme {

/// A number if there is one, otherwise words.
using Value = std::variant<double, std::string>;

/// The outcome of a case. One check gives its number; several are told in words, by name.
struct Outcome {
  Value measured = std::string("nothing was checked");
  Value limit = std::string("something");
  bool pass = false;
};

/// Conditions that a case runs under.
struct Conditions {
  bool quick = false;       ///< fewer random inputs, shorter scripts; the same oracles
  std::string folder;       ///< for files of its own
  std::string data;         ///< folder of the fuzzers' corpus
  std::uint64_t seed = 20;  ///< of generated inputs
  /// Returns `full` inputs, or a tenth of them in the quick form.
  int count(int full) const { return quick ? full / 10 : full; }
};

struct Case {
  const char* id;
  const char* input;      ///< what is fed
  const char* must_hold;  ///< the oracle, as numerics.md states it
  Outcome (*run)(const Conditions&);
  double time_s = 120;   ///< hard limit of the case's process; ten times that under sanitizers
  int memory_mb = 4096;  ///< limit of address space; none under AddressSanitizer
  bool alone = false;    ///< it measures time, so nothing else runs beside it
};

/// Collects the checks of one case. A NaN never passes.
class Checks {
 public:
  void at_most(const std::string& name, double measured, double limit);
  void at_least(const std::string& name, double measured, double limit);
  void equal(const std::string& name, double measured, double expected);
  void holds(const std::string& name, bool ok) { equal(name, ok ? 1 : 0, 1); }
  /// Notes that a step did not work on which the rest depends.
  void failed(const std::string& why);
  bool pass() const { return pass_ && !names_.empty(); }
  Outcome outcome() const;

 private:
  void add(const std::string& name, double measured, const char* relation, double limit, bool ok);
  std::vector<std::string> names_, measured_texts_, limit_texts_;
  double measured_ = 0, limit_ = 0;  ///< of the only check
  bool pass_ = true;
  bool numeric_ = true;
};

/// Formats as `%.4g`.
std::string number_text(double v);

}  // namespace mirage::extreme
