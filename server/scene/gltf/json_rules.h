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
  kIndex,         ///< index into the list `target`
  kIndexList,     ///< list of kIndex
  kIndexMap,      ///< object whose values are kIndex (attributes)
  kIndexMapList,  ///< list of kIndexMap (morph targets)
  kCountMap,      ///< object whose values are kCount
  kObject,        ///< object after `schema`
  kObjectList,    ///< list of kObject
};

struct Schema;

struct Rule {
  std::string_view key;
  Kind kind;
  bool required = false;
  std::string_view target = {};    ///< kIndex…: the list indexed
  const Schema* schema = nullptr;  ///< kObject…
  std::size_t size = 0;            ///< lists: exact length, 0 = any
};

struct Schema {
  std::vector<Rule> rules;
};

const Schema& root_schema();

}  // namespace mirage::gltf
