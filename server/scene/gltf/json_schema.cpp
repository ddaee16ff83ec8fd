#include "server/scene/gltf/json_schema.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <string>
#include <string_view>
#include <vector>

#include "server/scene/gltf/json_rules.h"

namespace mirage::gltf {
namespace {

using nlohmann::json;

constexpr double kMaxInteger = 2147483647.0;  // the parser keeps most integers in an int

/// The present place in the document; formatted only if an error needs it.
struct Place {
  const Place* parent = nullptr;
  std::string_view key;
  std::ptrdiff_t index = -1;

  std::string text() const {
    std::string out = parent != nullptr ? parent->text() : std::string();
    if (index >= 0) return out + "[" + std::to_string(index) + "]";
    if (!out.empty() && !key.empty()) out += ".";
    return out + std::string(key);
  }
};

/// True if `word` is one of `words`, which have spaces between them.
bool is_among(std::string_view word, std::string_view words) {
  for (std::size_t at = 0; at < words.size();) {
    const std::size_t end = std::min(words.find(' ', at), words.size());
    if (words.substr(at, end - at) == word) return true;
    at = end + 1;
  }
  return false;
}

Error type_error(const Place& place, const char* expected) {
  return make_error(ErrorId::kSceneFormat, place.text() + " is not " + expected);
}

class Sanitizer {
 public:
  Sanitizer(const json& root, Tally& tally) : tally_(tally) {
    for (const auto& [key, value] : root.items()) {
      if (value.is_array()) sizes_[key] = value.size();
    }
    take_size(root, "lights", "/extensions/KHR_lights_punctual/lights");
    take_size(root, "variants", "/extensions/KHR_materials_variants/variants");
  }

  Result<json> object(json& in, const Schema& schema, const Place& place) const {
    if (!in.is_object()) return type_error(place, "an object");
    json out = json::object();
    for (const Rule& rule : schema.rules) {
      const std::string key(rule.key);
      const auto found = in.find(key);
      const Place here{&place, rule.key};
      if (found == in.end()) {
        if (!rule.required) continue;
        return make_error(ErrorId::kSceneFormat, here.text() + " is missing");
      }
      if (rule.kind == Kind::kName) {
        if (found->is_string()) out[key] = std::move(*found);
        continue;
      }
      const bool unset = is_unset(*found, rule);
      auto value = any(*found, rule, here);
      if (value) {
        out[key] = value.take();
        continue;
      }
      if (rule.required || (rule.flaw == Flaw::kObject && !unset)) return value.error();
      auto ok = tally_.lose(unset ? "unset properties written as null or -1"
                                  : "properties that cannot be used left out",
                            value.error());
      if (!ok) return ok.error();
    }
    return out;
  }

 private:
  static bool is_unset(const json& value, const Rule& rule) {
    return value.is_null() || (rule.kind == Kind::kIndex && value == -1);
  }
  void take_size(const json& root, const char* name, const char* pointer) {
    const json::json_pointer place(pointer);
    if (root.contains(place) && root.at(place).is_array()) sizes_[name] = root.at(place).size();
  }

  Result<json> any(json& in, const Rule& rule, const Place& place) const {
    switch (rule.kind) {
      case Kind::kObject:
        return object(in, *rule.schema, place);
      case Kind::kObjectList:
      case Kind::kIndexList:
      case Kind::kIndexMapList:
      case Kind::kNumbers:
      case Kind::kTexts:
        return list(in, rule, place);
      case Kind::kIndexMap:
      case Kind::kCountMap:
        return index_map(in, rule, place);
      default:
        return scalar(in, rule, place);
    }
  }

  Result<json> list(json& in, const Rule& rule, const Place& place) const {
    if (!in.is_array()) return type_error(place, "an array");
    if (rule.size > 0 && in.size() != rule.size) {
      return make_error(ErrorId::kSceneFormat, place.text() + " has " + std::to_string(in.size()) +
                                                   " elements, needs " + std::to_string(rule.size));
    }
    Rule element = rule;
    switch (rule.kind) {
      case Kind::kObjectList:
        element.kind = Kind::kObject;
        break;
      case Kind::kIndexList:
        element.kind = Kind::kIndex;
        break;
      case Kind::kIndexMapList:
        element.kind = Kind::kIndexMap;
        break;
      case Kind::kTexts:
        element.kind = Kind::kText;
        break;
      default:
        element.kind = Kind::kNumber;
        break;
    }
    json out = json::array();
    for (std::size_t i = 0; i < in.size(); ++i) {
      auto value = any(in[i], element, Place{&place, {}, static_cast<std::ptrdiff_t>(i)});
      if (value) {
        out.push_back(value.take());
        continue;
      }
      if (!forgivable(rule)) return value.error();
      auto ok = tally_.lose("elements that cannot be used left out", value.error());
      if (!ok) return ok.error();
      if (rule.kind == Kind::kIndexMapList) out.push_back(json::object());
      if (!rule.stand_in.empty()) out.push_back(json::parse(rule.stand_in));
    }
    return out;
  }

  /// True if one element of a list can be left out without changing what the others mean.
  static bool forgivable(const Rule& rule) {
    switch (rule.kind) {
      case Kind::kObjectList:
        return rule.stand_in != kWholeList;
      case Kind::kIndexList:
        return !rule.required;
      case Kind::kIndexMapList:
      case Kind::kTexts:
        return true;
      default:
        return false;
    }
  }

  Result<json> index_map(json& in, const Rule& rule, const Place& place) const {
    if (!in.is_object()) return type_error(place, "an object");
    Rule element = rule;
    element.kind = rule.kind == Kind::kCountMap ? Kind::kCount : Kind::kIndex;
    json out = json::object();
    for (auto it = in.begin(); it != in.end(); ++it) {
      auto value = scalar(it.value(), element, Place{&place, it.key()});
      if (value) {
        out[it.key()] = value.take();
        continue;
      }
      auto ok = tally_.lose("properties that cannot be used left out", value.error());
      if (!ok) return ok.error();
    }
    return out;
  }

  Result<json> scalar(json& in, const Rule& rule, const Place& place) const {
    switch (rule.kind) {
      case Kind::kText:
        if (!in.is_string()) return type_error(place, "a string");
        return json(std::move(in));
      case Kind::kChoice:
        if (!in.is_string() || !is_among(in.get_ref<const std::string&>(), rule.target)) {
          return type_error(place, ("one of " + std::string(rule.target)).c_str());
        }
        return json(std::move(in));
      case Kind::kFlag:
        if (!in.is_boolean()) return type_error(place, "true or false");
        return json(in.get<bool>());
      case Kind::kNumber:
        if (!in.is_number() || !std::isfinite(in.get<double>())) {
          return type_error(place, "a finite number");
        }
        return json(in.get<double>());
      default:
        return integer(in, rule, place);
    }
  }

  Result<json> integer(json& in, const Rule& rule, const Place& place) const {
    if (!in.is_number()) return type_error(place, "an integer");
    const double value = in.get<double>();
    if (value != std::floor(value)) return type_error(place, "an integer");
    if (rule.kind == Kind::kComponent) {
      if (value >= 5120 && value <= 5126) return json(static_cast<std::int64_t>(value));
      return make_error(ErrorId::kSceneFormat,
                        place.text() + " = " + in.dump() + " is no type of components");
    }
    if (rule.kind == Kind::kCount) {
      if (value < 0 || value > kMaxInteger) {
        return make_error(ErrorId::kSceneRange,
                          place.text() + " = " + in.dump() + " is outside 0..2147483647");
      }
      return json(static_cast<std::int64_t>(value));
    }
    const auto size = sizes_.find(rule.target);
    const std::size_t limit = size == sizes_.end() ? 0 : size->second;
    if (value < 0 || value >= static_cast<double>(limit)) {
      return make_error(ErrorId::kSceneReference,
                        place.text() + " = " + in.dump() + ", but there " + "are " +
                            std::to_string(limit) + " " + std::string(rule.target));
    }
    return json(static_cast<std::int64_t>(value));
  }

  Tally& tally_;
  std::map<std::string, std::size_t, std::less<>> sizes_;
};

}  // namespace

Result<json> sanitize(json&& document, Tally& tally) {
  const Sanitizer sanitizer(document, tally);
  return sanitizer.object(document, root_schema(), Place{});
}

}  // namespace mirage::gltf
