#pragma once
// Choice log: which clip and variant a person asks for, and what the log tells of them.

#include <optional>

#include "protocol/model/scene_types.h"

namespace mirage {

class ChoiceLog {
 public:
  explicit ChoiceLog(SceneChoice asked) : asked_(std::move(asked)) {}
  /// Returns what was asked for last.
  const SceneChoice& asked() const { return asked_; }
  /// Asks for the clip or the variant after the one that is shown; the first follows the last.
  /// Returns false if that is what is shown already.
  bool ask_next(const SceneChoices& offered, bool clip, bool variant);
  /// Tells in the log what is shown, once it is another, and what was asked for in vain.
  void note(const SceneChoices& offered);

 private:
  SceneChoice asked_;
  std::optional<SceneChoice> told_;
};

}  // namespace mirage
