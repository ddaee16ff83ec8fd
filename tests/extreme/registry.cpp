#include "tests/extreme/registry.h"

namespace mirage::extreme {
namespace {

struct Letter {
  char letter;
  int count;  ///< number of ids in numerics.md section 6
};
constexpr Letter kLetters[] = {{'G', 16}, {'V', 12}, {'L', 9}, {'A', 7}, {'D', 5},
                               {'T', 5},  {'N', 6},  {'P', 9}, {'C', 4}, {'R', 8}};

}  // namespace

std::vector<Case> all_cases() {
  std::vector<Case> out;
  for (const auto& list :
       {geometry_cases, view_cases, lighting_cases, alpha_cases, depth_cases, texture_cases,
        network_cases, prediction_cases, control_cases, wire_cases}) {
    const std::vector<Case> cases = list();
    out.insert(out.end(), cases.begin(), cases.end());
  }
  return out;
}

std::optional<std::string> misplaced_id(const std::vector<Case>& cases) {
  for (const Letter& l : kLetters) {
    bool any = false;
    for (const Case& one : cases) any = any || one.id[0] == l.letter;
    for (int n = 1; any && n <= l.count; ++n) {
      const std::string id = l.letter + std::to_string(n);
      int found = 0;
      for (const Case& one : cases) found += one.id == id ? 1 : 0;
      if (found != 1) return id;
    }
  }
  return std::nullopt;
}

}  // namespace mirage::extreme
