#include "server/scene/gltf/json_read.h"

#include <algorithm>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "server/scene/gltf/gltf_limits.h"
#include "server/scene/gltf/json_mend.h"

namespace mirage::gltf {
namespace {

using nlohmann::json;

/// Returns where a byte, counted from 1, lies in a text: "in line 3, column 7".
std::string place_in(std::string_view text, std::size_t byte) {
  const std::string_view before = text.substr(0, byte > 0 ? byte - 1 : 0);
  const auto line = 1 + std::count(before.begin(), before.end(), '\n');
  const std::size_t begin = before.rfind('\n');
  const std::size_t column = before.size() - (begin == std::string_view::npos ? 0 : begin + 1) + 1;
  return "in line " + std::to_string(line) + ", column " + std::to_string(column);
}

/// Builds a tree from the events of nlohmann's parser (the interface of json::json_sax_t). Its own
/// parser with a filter is not used: it walks the whole list after each element.
class TreeBuilder {
 public:
  TreeBuilder(std::string_view text, const SceneLimits& limits) : text_(text), limits_(limits) {}

  bool null() { return scalar(nullptr); }
  bool boolean(bool value) { return scalar(value); }
  bool number_integer(std::int64_t value) { return scalar(value); }
  bool number_unsigned(std::uint64_t value) { return scalar(value); }
  bool number_float(double value, const std::string& /*text*/) { return scalar(value); }
  bool string(std::string& value) { return scalar(std::move(value)); }
  bool binary(json::binary_t& /*value*/) { return false; }  // a JSON text has none

  bool start_object(std::size_t /*count*/) { return open(json::object()); }
  bool start_array(std::size_t /*count*/) { return open(json::array()); }
  bool end_object() { return close(); }
  bool end_array() { return close(); }

  bool key(std::string& name) {
    if (left_out_ > 0) return true;
    Level& level = levels_.back();
    if (level.is_extras && name != "mirage") {
      value_is_left_out_ = true;
      return true;
    }
    value_is_extras_ = name == "extras";
    const auto [place, is_new] = level.value->emplace(std::move(name), nullptr);
    if (!is_new && !std::exchange(level.names_twice, true)) ++twice_;
    place_ = &*place;
    return true;
  }

  bool parse_error(std::size_t byte, const std::string& /*token*/, const json::exception& error) {
    constexpr int kNumberOutOfRange = 406;  // as nlohmann numbers its errors
    return fail(
        make_error(ErrorId::kSceneFormat, error.id == kNumberOutOfRange
                                              ? "JSON holds a number beyond double precision"
                                              : "JSON syntax error " + place_in(text_, byte)));
  }

  json take_root() { return std::move(root_); }
  /// Returns the number of objects that name a property twice.
  std::uint64_t twice() const { return twice_; }
  /// Returns why the parser stopped, if it did.
  const std::optional<Error>& error() const { return error_; }

 private:
  struct Level {
    json* value;
    bool is_extras;
    bool names_twice = false;
  };

  bool fail(Error error) {
    error_ = std::move(error);
    return false;
  }

  /// Puts a value into its place. Returns nullptr for one that is left out.
  json* put(json value) {
    if (left_out_ > 0 || std::exchange(value_is_left_out_, false)) return nullptr;
    ++values_;
    if (levels_.empty()) {
      root_ = std::move(value);
      return &root_;
    }
    json& parent = *levels_.back().value;
    if (parent.is_array()) {
      parent.push_back(std::move(value));
      return &parent.back();
    }
    *place_ = std::move(value);
    return place_;
  }

  bool scalar(json value) {
    value_is_extras_ = false;
    put(std::move(value));
    return fits();
  }

  bool open(json container) {
    const bool is_extras = std::exchange(value_is_extras_, false);
    if (is_extras && container.is_array()) value_is_left_out_ = true;
    json* value = put(std::move(container));
    if (value == nullptr) {
      ++left_out_;
    } else {
      levels_.push_back({value, is_extras});
    }
    if (levels_.size() + left_out_ > static_cast<std::size_t>(kMaxJsonDepth)) {
      return fail(make_error(ErrorId::kSceneLimit, "JSON nested deeper than " +
                                                       std::to_string(kMaxJsonDepth) + " levels"));
    }
    return fits();
  }

  bool close() {
    if (left_out_ > 0) {
      --left_out_;
    } else {
      levels_.pop_back();
    }
    return true;
  }

  bool fits() {
    if (values_ <= limits_.json_values) return true;
    return fail(
        limits_.exceeded_at_least(values_, limits_.json_values, "values in JSON", "join IN OUT"));
  }

  const std::string_view text_;  ///< for telling where it is wrong
  const SceneLimits& limits_;
  json root_;
  std::vector<Level> levels_;       ///< the open values that are kept
  json* place_ = nullptr;           ///< of the value that comes, in an object
  std::size_t left_out_ = 0;        ///< open values that are left out, inside the kept ones
  bool value_is_left_out_ = false;  ///< the value that comes
  bool value_is_extras_ = false;    ///< the value that comes
  std::uint64_t values_ = 0;
  std::uint64_t twice_ = 0;
  std::optional<Error> error_;
};

Result<json> build_tree(std::string_view text, const SceneLimits& limits, std::uint64_t& twice) {
  TreeBuilder builder(text, limits);
  json::sax_parse(text.begin(), text.end(), &builder);
  if (builder.error()) return *builder.error();
  twice = builder.twice();
  return builder.take_root();
}

}  // namespace

Result<json> read_json(std::string_view text, const SceneLimits& limits, Tally& tally) {
  if (text.size() > limits.json_bytes) {
    return limits.exceeded(text.size(), limits.json_bytes, "bytes of JSON");
  }
  std::uint64_t twice = 0;
  auto root = build_tree(text, limits, twice);
  if (!root && root.error().id == ErrorId::kSceneFormat) {
    const std::string mended = mend_json(text);
    auto second = mended == text ? root : build_tree(mended, limits, twice);
    if (second) {
      auto ok = tally.forgive(
          "files with text that is not UTF-8, or numbers that are not finite, in JSON",
          root.error());
      if (!ok) return ok.error();
      root = std::move(second);
    }
  }
  if (!root) return root.error();
  if (twice > 0) {  // glTF §2.7 forbids it; parsers take the last
    auto ok =
        tally.forgive("files with duplicate names in JSON, the last of each counts",
                      make_error(ErrorId::kSceneFormat,
                                 std::to_string(twice) + " JSON objects name a property twice"));
    if (!ok) return ok.error();
  }
  return root;
}

}  // namespace mirage::gltf
