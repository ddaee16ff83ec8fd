#pragma once
// View stage: lets the view tile stand for objects without an image.
// Input:  views that arrive, the draw list and what it lacks.
// Output: the part of the view that is drawn, and a request for another view where that is not
//         enough.
// Thread: the frame loop's.
// Full:   never; one request at a time.

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

  /// Restarts for a new connection, where the requested view will not come. Keeps the present view.
  void reset() {
    pending_ = 0;
    planned_from_.reset();
  }
  /// Forgets the view, because the scene is another.
  void forget() {
    light_.reset();
    view_.reset();
    fit_.reset();
    planned_from_.reset();
  }

  /// Takes a reply and returns its view; nullptr: it was not asked for. Errors kWireValue and
  /// kCodec: it is damaged.
  Result<std::shared_ptr<const ViewTile>> take(const Message& message);
  /// Takes a refusal; returns true if it was for a view.
  bool refused(const wire::RefusedT& refused, std::int64_t now_us);

  /// Shows all of the view, while the scene is not there yet.
  void show_all(DrawList& list);
  /// Shows the part of the view for which `list` has no image, and marks placeholders as covered.
  /// What is seen from elsewhere than in the view, or has moved since, is neither shown nor
  /// covered.
  void show_missing(const SceneView& scene, const Camera& camera, double time_s, DrawList& list);
  /// Returns the view to ask for. `predicted` is the eye when the reply arrives, `light` the serial
  /// of the present lighting. It asks for one view per place and light, because a second view from
  /// there would show nothing more. While the light changes, it asks once a second. If the eye has
  /// stood for a second, it asks for whatever still lacks a picture.
  std::optional<wire::ViewRequestT> plan(const SceneView& scene, const Camera& predicted,
                                         double time_s, std::uint32_t light, const DrawList& list,
                                         std::int64_t now_us);
  /// Notes that a request with this number is sent.
  void asked(std::uint32_t request_id) {
    pending_ = request_id;
    ++counts_.asked;
  }

  const ViewCounts& counts() const { return counts_; }
  /// Returns how well the view shows objects; nullptr: there is none.
  const ViewFit* fit() const { return fit_ ? &*fit_ : nullptr; }
  bool here() const { return view_ != nullptr; }
  bool enabled() const { return enabled_; }

 private:
  /// Sets in `owners` whether the view stands in for the instance, or for each member of a group.
  /// Returns true if the view shows any of them.
  bool mark(const InstanceView& instance, bool shown, std::vector<bool>& owners) const;
  void note_drawn();
  /// True if the view shows much of the picture in another light, and it is time to ask for one in
  /// this light.
  bool outdated(const SceneView& scene, const Camera& camera, std::uint32_t light,
                const DrawList& list, std::int64_t now_us);

  bool enabled_;
  std::shared_ptr<const ViewTile> view_;
  std::optional<ViewFit> fit_;                ///< fit of the view
  bool drawn_ = false;                        ///< some frame has shown the view
  std::uint32_t pending_ = 0;                 ///< number of the request; 0: none
  std::optional<Camera> planned_from_;        ///< camera of the last request
  std::optional<Camera> stands_at_;           ///< camera of the last frame
  std::int64_t stands_since_us_ = 0;          ///< since when
  std::optional<std::uint32_t> light_;        ///< serial of the view's lighting
  std::optional<std::uint32_t> asked_light_;  ///< that of the request under way
  std::uint32_t seen_light_ = 0;              ///< lighting of the last frame
  std::int64_t seen_light_since_us_ = 0;      ///< when it became that
  std::int64_t asked_us_ = INT64_MIN;         ///< when the last view was asked for
  std::int64_t not_before_us_ = INT64_MIN;
  ViewCounts counts_;
};

}  // namespace mirage
