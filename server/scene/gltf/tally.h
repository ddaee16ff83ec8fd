#pragma once
// Counts recoverable defects: one line per kind, however often it occurs.

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "protocol/base/result.h"

namespace mirage::gltf {

class Tally {
 public:
  /// `strict`: nothing is forgiven.
  explicit Tally(bool strict = false) : strict_(strict) {}

  /// Forgives a violation of the specification that viewers accept: counts it as `what` with the
  /// text of `defect` as its example. When strict, returns it as an error.
  Result<void> forgive(std::string_view what, const Error& defect);
  /// Forgives a defect that may cost something to draw.
  Result<void> lose(std::string_view what, const Error& defect);
  /// Returns the first defect that may have cost something to draw: the reason if nothing is left.
  const std::optional<Error>& first_loss() const { return first_loss_; }
  /// Adds `count` cases of `what` ("triangles with a NaN vertex dropped"); nothing if 0. The first
  /// non-empty `example` is kept and printed.
  void add(std::string_view what, std::uint64_t count = 1, std::string_view example = {});
  /// Adds a separate line that is not counted.
  void note(std::string line);
  std::vector<std::string> lines() const;

 private:
  struct Row {
    std::string what;
    std::string example;
    std::uint64_t count = 0;
  };
  bool strict_ = false;
  std::optional<Error> first_loss_;
  std::vector<Row> rows_;  // in order of first occurrence; at most a few dozen kinds
};

}  // namespace mirage::gltf
