#pragma once
// Impostor groups: all instances of a spatial cell as one object, for far views. Groups nest; a
// scene is told to clients group by group, as their views need the members.

#include <cstdint>

#include "protocol/impostor/object_proxy.h"
#include "protocol/model/scene_types.h"

namespace mirage {

inline constexpr std::uint32_t kNoGroup = 0xffffffffu;
/// A group never stands for its members nearer than this many of its radii.
inline constexpr double kGroupRadii = 4;
/// Nearer than this many of its radii, an instance that is cut is shown as its parts, unless it is
/// geometry.
inline constexpr double kPartRadii = 1.5;
/// A group stands for its members where its image is expected to last this long.
inline constexpr double kGroupLifeS = 3;

/// What either end needs to know of a group to draw it, ask for it and bound its error. As an
/// instance it sits at `center` without rotation or scale; its object space is the world around
/// that point.
struct GroupBounds {
  glm::dvec3 center{0};     ///< world, m
  glm::vec3 half{0};        ///< of the box around its members, m
  glm::vec3 mean_color{0};  ///< linear, in steps of 1/255
  NeedMask needs = 0;       ///< of all members

  /// Of a box in the world, m; rounded up, so that what is in it is inside in float as well.
  static GroupBounds around(const glm::dvec3& low, const glm::dvec3& high);
  /// Clamps to 0..1 and rounds to what travels.
  void set_mean_color(const glm::vec3& linear);
};

/// The group as an object: its box is its hull. A pure function, so that both ends have the same.
ObjectDescription group_description(const GroupBounds& bounds);

// The planning defaults that decide how long an image lasts before a tile has told.
inline constexpr double kTypicalGap = 0.6;  ///< deepest step in an object's depth, radii
/// A disocclusion may be as wide as this share of the projected radius; less below a tau of 1 px.
inline constexpr double kHoleShare = 0.15;
/// Disocclusions may be at most this many times as wide as a position error (numerics.md: the real
/// knob once there is depth).
inline constexpr double kHoleTolerance = 8;
inline constexpr double kLeadShare =
    0.6;  ///< of the allowed baseline: how far a capture lies ahead

/// How near a viewer has to be to need the members of a group.
struct OpenRule {
  double focal_px = 1000;
  double tau_px = 1;
  double speed_mps = 1.4;
  double margin = 1;  ///< factor on the distance, >= 1, for what comes next
};
/// Distance from the eye to the centre of a group of this radius below which its members are
/// needed, m: where no image of it lasts kGroupLifeS (the selector's test, solved for the distance
/// and rounded up).
double open_distance(const OpenRule& rule, double radius);

/// Factor on the error an instance may show: 2 for scenery, 1/2 for what is important, else 1. No
/// more than that: the baseline a tile allows grows with its error, so either way the tiles
/// an object needs change by a factor of two along a path, and a bound stays one of a few pixels.
double tolerance(Importance importance);

}  // namespace mirage
