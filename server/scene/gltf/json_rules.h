#pragma once
// glTF 2.0 properties as a table of rules (specification §5, and the extensions we read).

#include <cstddef>
#include <string_view>
#include <vector>

namespace mirage::gltf {

enum class Kind {
  kName,          ///< string; other types are left out, as names carry no meaning
  kText,          ///< string
  kTexts,         ///< list of strings
  kFlag,          ///< boolean
  kNumber,        ///< finite number
  kNumbers,       ///< list of finite numbers
  kCount,         ///< integer in 0..2^31-1
  kComponent,     ///< type of an accessor's components, 5120 to 5126
  kChoice,        ///< one of the words in `target`
  kIndex,         ///< index into the list `target`
  kIndexList,     ///< list of kIndex
  kIndexMap,      ///< object whose values are kIndex (attributes)
  kIndexMapList,  ///< list of kIndexMap (morph targets)
  kCountMap,      ///< object whose values are kCount
  kObject,        ///< object after `schema`
  kObjectList,    ///< list of kObject
};

struct Schema;

/// Flaw: what a property that cannot be used costs.
enum class Flaw {
  kItself,  ///< it counts as not given
  kObject,  ///< the object around it cannot be used either: without it, it would mean another thing
};

/// Rule::stand_in: one element that cannot be used costs the whole list.
inline constexpr std::string_view kWholeList = "list";

struct Rule {
  std::string_view key;
  Kind kind;
  bool required = false;
  std::string_view target = {};  ///< kIndex…: the list indexed; kChoice: words with spaces between
  const Schema* schema = nullptr;  ///< kObject…
  std::size_t size = 0;            ///< lists: exact length, 0 = any
  Flaw flaw = Flaw::kItself;
  /// kObjectList: JSON that takes the place of an element that cannot be used, so that indices of
  /// later ones stay; empty: it is removed.
  std::string_view stand_in = {};
};

struct Schema {
  std::vector<Rule> rules;
};

const Schema& root_schema();

}  // namespace mirage::gltf
