#pragma once
// View stage.
// Input:  views as they come, what a frame draws and lacks. Output: which part of the view stands
//         in for what has no image, and a request for another view where it does not.
// Thread: the frame loop's. Never full: one request at a time.

#include <cstdint>
#include <memory>
#include <optional>
#include <vector>

#include "client/price/view_fit.h"
#include "client/session/counts.h"
#include "protocol/base/result.h"
#include "protocol/impostor/camera.h"

namespace mirage {

struct Message;
struct DrawList;
struct InstanceView;
class SceneView;
struct ViewTile;
namespace wire {
struct RefusedT;
struct ViewReplyT;
struct ViewRequestT;
}  // namespace wire

class ViewStage {
 public:
  explicit ViewStage(bool enabled) : enabled_(enabled) {}

  /// A new connection: what was asked for will not come. What is here stays.
  void reset() {
    pending_ = 0;
    planned_from_.reset();
  }
  /// Another scene.
  void forget() {
    view_.reset();
    fit_.reset();
    planned_from_.reset();
  }

  /// A reply; nullptr: it was not asked for. Error kWireValue, kCodec: it is damaged.
  Result<std::shared_ptr<const ViewTile>> take(const Message& message);
  /// True: the refusal was of a view.
  bool refused(const wire::RefusedT& refused, std::int64_t now_us);

  /// All of the view, while the scene is not there yet.
  void show_all(DrawList& list);
  /// The part that shows what `list` has no image for; placeholders that it shows are covered.
  void show_missing(const SceneView& scene, const Camera& camera, DrawList& list);
  /// What to ask for. `predicted`: where the eye will be when the reply comes. From one place once:
  /// what the view from there does not show, another will not.
  std::optional<wire::ViewRequestT> plan(const SceneView& scene, const Camera& predicted,
                                         double time_s, const DrawList& list, std::int64_t now_us);
  /// A request is sent by this number.
  void asked(std::uint32_t request_id) {
    pending_ = request_id;
    ++counts_.asked;
  }

  const ViewCounts& counts() const { return counts_; }
  /// How well it shows what; nullptr: there is none.
  const ViewFit* fit() const { return fit_ ? &*fit_ : nullptr; }
  bool here() const { return view_ != nullptr; }
  bool enabled() const { return enabled_; }

 private:
  /// Owners that are in the list as what has an image, or as what has none.
  /// Whether there are any.
  bool mark(const InstanceView& instance, bool shown, std::vector<bool>& owners) const;
  void note_drawn();

  bool enabled_;
  std::shared_ptr<const ViewTile> view_;
  std::optional<ViewFit> fit_;          ///< of it
  bool drawn_ = false;                  ///< view_ was
  std::uint32_t pending_ = 0;           ///< request; 0: none
  std::optional<Camera> planned_from_;  ///< the last one
  std::int64_t not_before_us_ = INT64_MIN;
  ViewCounts counts_;
};

}  // namespace mirage
