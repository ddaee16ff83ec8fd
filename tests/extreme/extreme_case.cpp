#include "tests/extreme/extreme_case.h"

#include <cstdio>

namespace mirage::extreme {
namespace {

std::string joined(const std::vector<std::string>& names, const std::vector<std::string>& texts) {
  std::string out;
  for (std::size_t i = 0; i < names.size(); ++i) {
    out += (i > 0 ? "; " : "") + names[i] + " " + texts[i];
  }
  return out;
}

}  // namespace

std::string number_text(double v) {
  char text[32];
  std::snprintf(text, sizeof text, "%.4g", v);
  return text;
}

void Checks::add(const std::string& name, double measured, const char* relation, double limit,
                 bool ok) {
  names_.push_back(name);
  measured_texts_.push_back(number_text(measured) + (ok ? "" : " (!)"));
  limit_texts_.push_back(std::string(relation) + " " + number_text(limit));
  measured_ = measured;
  limit_ = limit;
  pass_ = pass_ && ok;
}

void Checks::at_most(const std::string& name, double measured, double limit) {
  add(name, measured, "<=", limit, measured <= limit);
}

void Checks::at_least(const std::string& name, double measured, double limit) {
  add(name, measured, ">=", limit, measured >= limit);
}

void Checks::equal(const std::string& name, double measured, double expected) {
  add(name, measured, "=", expected, measured == expected);
}

void Checks::failed(const std::string& why) {
  names_.push_back("failed:");
  measured_texts_.push_back(why);
  limit_texts_.emplace_back("none");
  pass_ = numeric_ = false;
}

Outcome Checks::outcome() const {
  if (names_.empty()) return {};
  if (numeric_ && names_.size() == 1) return {measured_, limit_, pass_};
  return {joined(names_, measured_texts_), joined(names_, limit_texts_), pass_};
}

}  // namespace mirage::extreme
