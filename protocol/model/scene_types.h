#pragma once
// Scene data that client and server share: instances, lights, environment, home view, choices.

#include <cstdint>
#include <glm/glm.hpp>
#include <glm/gtc/quaternion.hpp>
#include <optional>
#include <string>
#include <vector>

namespace mirage {

/// world_from_object as a similarity: world = position + rotation * (scale * object).
/// Shear, non-uniform scale and mirroring are baked into the object's mesh on import, so angles
/// and the error bound carry over unchanged.
struct Similarity {
  glm::dvec3 position{0};          ///< metres
  glm::quat rotation{1, 0, 0, 0};  ///< unit quaternion
  float scale = 1;                 ///< > 0
};

/// Importance of an instance in its scene: scenery may show more error, important instances less.
/// Things drawn as one have the largest importance of their parts.
enum class Importance : std::uint8_t { kScenery, kNormal, kImportant };

struct Instance {
  std::uint32_t object = 0;
  Similarity world_from_object;
  float clip_offset_s = 0;  ///< added to the animation time; ignored for a static object
  Importance importance = Importance::kNormal;
};

enum class LightKind : std::uint8_t { kDirectional, kPoint, kSpot };

/// A punctual light (KHR_lights_punctual), linear light. Directional: color is irradiance per pi;
/// point and spot: intensity, falling off with the squared distance in metres.
struct Light {
  LightKind kind = LightKind::kDirectional;
  glm::vec3 color{1};             ///< linear RGB times intensity, >= 0
  glm::dvec3 position{0};         ///< world; unused for directional
  glm::vec3 direction{0, -1, 0};  ///< world, unit, the direction in which light travels
  float range = 0;                ///< metres; 0: unlimited
  float cos_inner = 1;
  float cos_outer = 0;
};

/// Light from all around, as the scene's light probe holds it (light_probe.h).
struct ProbeLight {
  std::uint64_t id = 0;            ///< of the probe, a hash of its content; 0: none
  glm::quat rotation{1, 0, 0, 0};  ///< turns the probe's axes into the world, unit
  float strength = 1;              ///< factor on its radiance, >= 0

  bool shines() const { return id != 0 && strength > 0; }
};

/// Lighting state in world space.
struct Lighting {
  glm::vec3 ambient{0.6f};  ///< linear radiance from every direction
  std::vector<Light> lights;
  ProbeLight probe;
};

/// Curve that brings shaded colours into the range of a screen.
enum class ToneCurve : std::uint8_t {
  kClip,     ///< what is above 1 is cut off
  kNeutral,  ///< Khronos PBR Neutral: highlights keep their shape and hue
};

/// Floor under a scene that stands in a studio. It belongs to the background: objects cover it, and
/// it covers nothing.
struct StudioFloor {
  static constexpr int kEdge = 64;  ///< cells of the shadow along a side

  glm::dvec3 center{0};  ///< a point of the floor, under the middle of the scene, m
  float half = 0;        ///< half the side of the shadow's square, m; 0: there is no floor
  glm::vec3 color{0};    ///< linear RGB, where no shadow is
  /// Share of the light that the scene takes from each cell, 255: all; kEdge rows along +z.
  std::vector<std::uint8_t> shadow;
};

/// Background where no object is: a vertical gradient, linear RGB, and how colours are shown.
struct Environment {
  glm::vec3 zenith{0.216f};
  glm::vec3 horizon{0.216f};
  glm::vec3 nadir{0.216f};
  float fog_density = 0;  ///< per metre, with the horizon's colour; 0: none
  ToneCurve tone = ToneCurve::kClip;
  StudioFloor floor = {};
};

/// Start of a viewer, and the loop that `builtin:walk` follows. The loop is a circle of radius
/// `walk_radius_m` through `eye`, tangent there to the viewing direction, turning right. The
/// shipped scenes keep it level and free of objects.
struct HomeView {
  glm::dvec3 eye{0, 1.7, 0};
  glm::dvec3 target{0, 1.7, -1};
  double walk_radius_m = 20;
  double walk_speed_mps = 1.4;
  double walk_eye_m = 0;  ///< of WalkBody (ground.h)
  /// Points of the scene, relative to `target`, that fill the picture (home_pose()); empty: the eye
  /// stays where it is, whatever the picture's shape.
  std::vector<glm::vec3> fit = {};
};

/// A viewer's choice in a scene: the clip that plays, and the variant of its materials.
struct SceneChoice {
  std::string clip;     ///< empty: as the scene is served
  std::string variant;  ///< empty: as the scene is served

  friend bool operator==(const SceneChoice& a, const SceneChoice& b) {
    return a.clip == b.clip && a.variant == b.variant;
  }
  friend bool operator!=(const SceneChoice& a, const SceneChoice& b) { return !(a == b); }
};

/// The choices that a scene offers, and the one that is shown. A clip without a name of its own is
/// called by its place in the file, from 0.
struct SceneChoices {
  std::vector<std::string> clips, variants;
  SceneChoice shown;  ///< empty parts: all clips play; the file's initial materials
};

/// Returns what has to be shown instead of the shown choice; nullopt: nothing, because it is shown
/// already, or not offered. Empty parts of `wanted` stay as they are shown.
std::optional<SceneChoice> other_choice(const SceneChoices& offered, SceneChoice wanted);

}  // namespace mirage
