#pragma once
// An object's animation: node hierarchy, skin, morph targets and keys of one clip, and the one
// function that poses its vertices. Both ends use it, so tile, reference and client geometry agree.
//
// Rigid moving parts are skinned too, with weight 1 to their node: one mechanism for everything.

#include <cstdint>
#include <glm/glm.hpp>
#include <glm/gtc/quaternion.hpp>
#include <vector>

#include "protocol/model/model.h"

namespace mirage {

/// A node of the hierarchy. Parents come before their children; nodes without a parent hang in
/// object space.
struct Joint {
  std::int32_t parent = -1;
  bool moves = false;  ///< uses translation, rotation, scale; else `matrix`
  glm::mat4 matrix{1};
  glm::vec3 translation{0};  ///< at rest; channels replace some of these values
  glm::quat rotation{1, 0, 0, 0};
  glm::vec3 scale{1};
};

/// The target of a vertex: a joint, and the matrix from bind space into it.
struct JointBinding {
  std::uint16_t joint = 0;
  glm::mat4 joint_from_bind{1};
};

/// Up to four bindings; the weights sum to 1.
struct VertexBinding {
  glm::u16vec4 binding{0};
  glm::vec4 weight{1, 0, 0, 0};
};

/// Displacements of some vertices at weight 1, bind space.
struct MorphTarget {
  std::vector<std::uint32_t> vertex;  ///< index into the whole mesh, increasing
  std::vector<glm::vec3> position;    ///< this and the next have the length of `vertex`
  std::vector<glm::vec3> normal;
  std::vector<glm::vec3> tangent;
};

/// Targets that one list of weights drives.
struct MorphSet {
  std::vector<float> rest_weights;  ///< as many as targets
  std::vector<MorphTarget> targets;
};

enum class ChannelPath : std::uint8_t { kTranslation, kRotation, kScale, kWeights };
enum class Interpolation : std::uint8_t { kStep, kLinear, kCubicSpline };

/// Keys of one property. glTF layout: per key 3 (translation, scale), 4 (rotation: x, y, z, w) or
/// one value per target; cubic splines have in-tangent, value, out-tangent.
struct Channel {
  std::uint16_t target = 0;  ///< joint, or morph set for kWeights
  ChannelPath path = ChannelPath::kTranslation;
  Interpolation interpolation = Interpolation::kLinear;
  std::vector<float> times;  ///< s, strictly increasing, finite, >= 0, at least one
  std::vector<float> values;
};

struct Animation {
  float clip_s = 0;  ///< > 0
  std::vector<Joint> joints;
  std::vector<JointBinding> bindings;
  std::vector<VertexBinding> vertices;  ///< one per vertex of the mesh
  std::vector<MorphSet> morphs;
  std::vector<Channel> channels;
};

/// The time-dependent state of an animation.
struct AnimationState {
  std::vector<glm::mat4> object_from_bind;  ///< per binding
  std::vector<std::vector<float>> weights;  ///< per morph set
};

/// Writes the value of a channel at clip time `t`, `width` numbers. Times are clamped to the keys.
/// Rotations use shortest-arc slerp and have unit length; keys without length give the identity.
void sample_channel(const Channel& channel, double t, std::size_t width, double* out);
/// Returns the shortest-arc interpolation of unit quaternions, exact at small angles and at both
/// ends.
glm::dquat slerp_shortest(const glm::dquat& a, const glm::dquat& b, double s);

/// True if each vertex follows one joint, and nothing morphs.
bool moves_rigidly(const Animation& animation);

AnimationState evaluate(const Animation& animation, double clip_time_s);
/// Poses `bind` (as many vertices as animation.vertices) into `out`. Normals use the cofactor
/// matrix, so they stay right under uneven scale and mirroring.
void pose_vertices(const std::vector<Vertex>& bind, const Animation& animation, double clip_time_s,
                   std::vector<Vertex>& out);
/// Poses positions only, for measuring.
void pose_positions(const std::vector<Vertex>& bind, const Animation& animation, double clip_time_s,
                    std::vector<glm::vec3>& out);

}  // namespace mirage
