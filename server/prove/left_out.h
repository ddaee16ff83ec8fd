#pragma once
// The need analysis: everything left out of each object under a light, by rule, with the fact that
// allows it. Explain, proof and report all use it.

#include <string>
#include <vector>

#include "protocol/impostor/lighting_state.h"
#include "server/prepare/leave_out.h"

namespace mirage {

struct PreparedScene;

/// Returns everything left out of an object, in the order of the rules. `object` may be a group.
std::vector<LeftOut> left_out_of_object(const PreparedScene& scene, std::size_t object,
                                        const Lighting& lighting);

/// Returns everything left out of every object alike, and of the scene as a whole. `shadows`:
/// enabled.
std::vector<LeftOut> left_out_of_scene(const PreparedScene& scene, bool shadows);

/// Objects with the same content left out; classes are in the order of their first objects.
struct ObjectClass {
  std::vector<std::size_t> objects;
  std::vector<LeftOut> left_out;
};
std::vector<ObjectClass> object_classes(const PreparedScene& scene, const Lighting& lighting);

/// Returns the index of the first instance of every object; instance_count() if there is none.
std::vector<std::size_t> first_instances(const PreparedScene& scene);
/// Returns the object's name; a group's name is made from its size.
std::string object_name(const PreparedScene& scene, std::size_t object);
/// Returns "beech" or "beech and 3 more".
std::string class_name(const PreparedScene& scene, const ObjectClass& one);

}  // namespace mirage
