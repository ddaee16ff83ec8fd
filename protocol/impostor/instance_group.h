#pragma once
// Impostor groups: all instances of a spatial cell drawn as one object in far views. Groups nest.
// Clients are told a scene group by group, as their views need the members.

#include <cstdint>

#include "protocol/impostor/object_proxy.h"
#include "protocol/model/scene_types.h"

namespace mirage {

inline constexpr std::uint32_t kNoGroup = 0xffffffffu;
/// A group is never drawn in place of its members nearer than this many of its radii.
inline constexpr double kGroupRadii = 4;
/// Nearer than this many of its radii, a cut instance is shown as its parts, unless it is drawn as
/// geometry.
inline constexpr double kPartRadii = 1.5;
/// A group is drawn in place of its members if its image is expected to last this long, seconds.
inline constexpr double kGroupLifeS = 3;

/// The facts that both ends need to draw a group, ask for it and bound its error. As an instance it
/// sits at `center` without rotation or scale; its object space is the world around that point.
struct GroupBounds {
  glm::dvec3 center{0};     ///< world, m
  glm::vec3 half{0};        ///< half extents of the box around its members, m
  glm::vec3 mean_color{0};  ///< linear, in steps of 1/255
  NeedMask needs = 0;       ///< union over all members

  /// Returns the bounds of a world box (m), rounded up so that its content stays inside in float
  /// arithmetic.
  static GroupBounds around(const glm::dvec3& low, const glm::dvec3& high);
  /// Clamps to 0..1 and rounds to the steps sent on the wire.
  void set_mean_color(const glm::vec3& linear);
};

/// Returns the group as an object; its box is its hull. A pure function, so both ends get the same.
ObjectDescription group_description(const GroupBounds& bounds);

// Planning defaults for how long an image lasts, used before a tile has been measured.
inline constexpr double kTypicalGap = 0.6;  ///< deepest step in an object's depth, radii
/// Width that a disocclusion may have, as a share of the projected radius; less below a tau of 1
/// px.
inline constexpr double kHoleShare = 0.15;
/// Largest allowed ratio of disocclusion width to position error (decision 14); it decides how long
/// a tile with depth lasts.
inline constexpr double kHoleTolerance = 8;
inline constexpr double kLeadShare =
    0.6;  ///< how far ahead a capture lies, as a share of the allowed baseline

/// Inputs of the rule for how near a viewer must be to need the members of a group.
struct OpenRule {
  double focal_px = 1000;
  double tau_px = 1;
  double speed_mps = 1.4;
  double margin = 1;  ///< factor >= 1 on the distance, to open groups ahead of need
};
/// Returns the distance in m from the eye to a group's centre below which its members are needed:
/// there no image of the group lasts kGroupLifeS. It is the selector's test, solved for the
/// distance and rounded up.
double open_distance(const OpenRule& rule, double radius);

/// Returns the factor on the error an instance may show: 2 for scenery, 1/2 for important
/// instances, else 1. The allowed baseline grows with the error, so these factors change the tiles
/// an object needs along a path by two at most. Bounds stay within a few pixels.
double tolerance(Importance importance);

}  // namespace mirage
