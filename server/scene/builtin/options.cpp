#include "server/scene/builtin/options.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <numeric>

namespace mirage::builtin {
namespace {

std::string number_text(double value) {
  char text[32];
  const auto end = std::to_chars(text, text + sizeof text, value).ptr;
  return std::string(text, end);
}

std::string hint_for_key(const std::string& key, std::span<const OptionRule> rules) {
  std::vector<std::string> keys;
  std::string all;
  for (const OptionRule& rule : rules) {
    keys.emplace_back(rule.key);
    all += (all.empty() ? "" : ", ") + keys.back();
  }
  const std::string close = closest_name(key, keys);
  return (close.empty() ? "" : "did you mean " + close + "? ") + "allowed: " + all;
}

Result<double> parse_value(const std::string& scene, const OptionRule& rule,
                           const std::string& text) {
  double value = 0;
  const char* end = text.data() + text.size();
  const auto parsed = std::from_chars(text.data(), end, value);
  const bool number = parsed.ec == std::errc() && parsed.ptr == end && std::isfinite(value);
  const bool fits = number && value >= rule.low && value <= rule.high;
  if (fits && !(rule.whole && value != std::floor(value))) return value;
  return make_error(ErrorId::kSceneBuiltin,
                    scene + ": " + rule.key + "=" + text.substr(0, 40) + " is not allowed",
                    std::string(rule.key) +
                        (rule.whole ? " is a whole number from " : " is from ") +
                        number_text(rule.low) + " to " + number_text(rule.high));
}

}  // namespace

Result<OptionValues> parse_options(const std::string& scene, const std::string& text,
                                   std::span<const OptionRule> rules) {
  OptionValues values;
  for (const OptionRule& rule : rules) values.push_back(rule.fallback);
  std::vector<bool> seen(rules.size(), false);
  std::size_t at = 0;
  while (at < text.size()) {
    const std::size_t stop = std::min(text.find('&', at), text.size());
    const std::string pair = text.substr(at, stop - at);
    at = stop + 1;
    const std::size_t equals = std::min(pair.find('='), pair.size());
    const std::string key = pair.substr(0, equals);
    const auto rule =
        std::find_if(rules.begin(), rules.end(), [&](const OptionRule& r) { return key == r.key; });
    if (rule == rules.end()) {
      return make_error(ErrorId::kSceneBuiltin,
                        scene + ": unknown option '" + key.substr(0, 40) + "'",
                        hint_for_key(key, rules));
    }
    const auto index = static_cast<std::size_t>(rule - rules.begin());
    if (seen[index]) {
      return make_error(ErrorId::kSceneBuiltin, scene + ": option " + key + " given twice");
    }
    seen[index] = true;
    auto value = parse_value(scene, *rule, equals < pair.size() ? pair.substr(equals + 1) : "");
    if (!value) return value.error();
    values[index] = *value;
  }
  return values;
}

std::string describe_options(std::span<const OptionRule> rules) {
  std::string text;
  for (const OptionRule& rule : rules) {
    text += (text.empty() ? "" : " ") + std::string(rule.key) + "=" + number_text(rule.fallback);
  }
  return text;
}

std::string closest_name(const std::string& name, const std::vector<std::string>& candidates) {
  std::string best;
  std::size_t best_distance = 3;  // three edits make another word, not a typo
  if (name.size() > 64) return best;
  for (const std::string& candidate : candidates) {
    std::vector<std::size_t> row(candidate.size() + 1);
    std::iota(row.begin(), row.end(), std::size_t{0});
    for (std::size_t i = 0; i < name.size(); ++i) {
      std::size_t diagonal = row[0]++;
      for (std::size_t j = 0; j < candidate.size(); ++j) {
        const std::size_t replace = diagonal + (name[i] != candidate[j] ? 1 : 0);
        diagonal = row[j + 1];
        row[j + 1] = std::min({replace, row[j] + 1, diagonal + 1});
      }
    }
    if (row.back() < best_distance) {
      best_distance = row.back();
      best = candidate;
    }
  }
  return best;
}

}  // namespace mirage::builtin
