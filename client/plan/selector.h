#pragma once
// Selector: decides what is drawn, and what to ask for, by the error bound.
// Input:  scene, resident tiles, the true and the predicted camera.
// Output: what to draw now, and what to ask for.
// Thread: the frame loop's.
// Full:   never; one decision per visible instance and frame.
//
// Impostor groups (all instances of a spatial cell) form trees over the instances. Drawing and
// asking both walk down from the roots, and stop where a group will do.

#include <cstdint>
#include <memory>
#include <vector>

#include "client/frame/resident.h"
#include "client/plan/rent_or_buy.h"
#include "client/price/error_model.h"
#include "protocol/impostor/camera.h"

namespace mirage {

class SceneView;
struct Alternatives;
struct Choice;
struct DrawList;
struct MeshWants;
struct SelectorInput;
struct TileFit;
struct TileNeed;
struct ViewGeometry;
struct ViewPlan;

class Selector {
 public:
  Selector();
  ~Selector();
  Selector(Selector&&) noexcept;
  Selector& operator=(Selector&&) noexcept;

  /// Forgets which tile each instance showed.
  void reset(const SceneView& scene);
  /// Learns the instances that have arrived since.
  void grow(const SceneView& scene);

  /// Appends the alternatives of each visible thing to `things`.
  void consider(const SelectorInput& input, std::vector<Alternatives>& things);
  /// Returns what is drawn this frame. `choices` has one for each thing of the last consider(), in
  /// their order. The list's tiles must be marked in the cache before needs() is called.
  DrawList draw(const SelectorInput& input, const Choice* choices);
  /// Returns what to ask for, largest gain first: tiles of instances that have none that will do at
  /// the predicted view.
  std::vector<TileNeed> needs(const SelectorInput& input);
  /// Returns instances that should be geometry, whether it is here or not: too near for any
  /// impostor, or bought. Call it after needs() of the frame.
  MeshWants mesh_needs(const SelectorInput& input);
  /// Notes that a tile of the object has arrived.
  void note_tile(std::uint32_t object, double bytes) { geometry_.paid(object, bytes); }

 private:
  /// The last picture of an instance or group; transitions need it.
  struct Shown {
    TileRecordPtr tile;
    TileRecordPtr former;  ///< still drawn underneath while `tile` fades in
    std::int64_t since_us = 0;
    std::uint64_t frame = 0;               ///< last frame in which it was drawn
    std::int64_t appeared_us = 0;          ///< groups: when it replaced its members
    std::int64_t left_us = INT64_MIN / 2;  ///< groups: when its members replaced it
    bool as_mesh = false;
    Wrongs wrongs{};                          ///< error of what it showed last
    std::int64_t swapped_us = INT64_MIN / 2;  ///< when geometry replaced tiles, or tiles geometry
    DrawMethod method = DrawMethod::kQuad;    ///< method of `tile`
    DrawMethod former_method = DrawMethod::kQuad;
    std::uint64_t newest = 0;  ///< serial of the group's newest tile when it was chosen
    std::int64_t chosen_until_us = INT64_MIN / 2;   ///< no better flat tile is looked for before
    std::int64_t settled_until_us = INT64_MIN / 2;  ///< nothing is asked for before
  };
  /// Values that settled instances depend on, beside their tiles and time.
  struct Basis {
    double tau_px = 0, target_px = 0, pixel_px = 0, focal_px = 0, mesh_radii = 0;
    std::uint32_t light = 0;
    bool automatic = true, eight_views = false;
    DrawMethod method = DrawMethod::kQuad;
    glm::dvec3 eye{0};
    bool moving = false;
    std::int64_t now_us = 0;
  };
  /// A visible instance before it is decided how it is drawn.
  struct Candidate;
  struct Considered;
  struct Walk;

  void walk(Walk& walk, std::uint32_t instance, float fade);
  void walk_group(Walk& walk, std::uint32_t group, float fade);
  void consider(Walk& walk, std::uint32_t instance, float fade);
  void fit_tiles(const SelectorInput& in, Candidate& candidate) const;
  static TileFit fading_out(const Shown& shown, DrawMethod method, const Candidate& candidate);
  bool renew(const SelectorInput& in, std::uint32_t instance, const ViewGeometry& view,
             ViewPlan plan, const TileFit& fit, bool in_view, std::vector<TileNeed>& out);
  bool members_have_images(const Walk& walk, std::uint32_t group) const;
  bool group_serves(const Walk& walk, std::uint32_t group, const ViewGeometry& view) const;
  bool drawn_as_mesh(const SelectorInput& in, std::uint32_t instance) const;
  Alternatives alternatives(const SelectorInput& in, const Candidate& candidate) const;
  void add_levels(const SelectorInput& in, std::uint32_t instance, Alternatives& out) const;
  static bool view_shows(const SelectorInput& in, const Candidate& c);
  bool draw_geometry(const SelectorInput& in, Candidate& candidate, DrawList& out);
  void draw_candidate(const SelectorInput& in, const Candidate& candidate, DrawList& out);
  std::size_t things_in_view() const;
  bool keep_chosen(const SelectorInput& in, Candidate& candidate) const;
  void forget_settled(const SelectorInput& in);
  bool wants_members(const SelectorInput& in, std::uint32_t instance) const;
  void note_rent(const SelectorInput& in, const TileNeed& need);
  void note_strokes(const SelectorInput& in, std::uint32_t instance, const ViewGeometry& view,
                    const ViewPlan& plan);
  double geometry_gain(const SelectorInput& in, std::uint32_t instance) const;
  static double bytes_of(const SelectorInput& in, const TileNeed& need);
  bool members_are_geometry(const SelectorInput& in, std::uint32_t group) const;
  bool comes_soon(const SelectorInput& in, const TileNeed& need) const;
  bool shows_nothing(const SelectorInput& in, std::uint32_t instance) const;
  void add_need(const SelectorInput& in, std::uint32_t instance, bool in_view,
                std::vector<TileNeed>& out);

  std::vector<Shown> shown_;
  std::unique_ptr<Considered> considered_;  ///< by the last consider()
  RentOrBuy geometry_;
  Basis basis_;
};

}  // namespace mirage
