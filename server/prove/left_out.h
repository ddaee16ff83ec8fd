#pragma once
// What is left out of each object under a light, by rule, with the fact it rests on: the need
// analysis as explain, proof and report tell it.

#include <string>
#include <vector>

#include "protocol/impostor/lighting_state.h"
#include "server/prepare/leave_out.h"

namespace mirage {

struct PreparedScene;

/// In the order of the rules. `object` may be a group.
std::vector<LeftOut> left_out_of_object(const PreparedScene& scene, std::size_t object,
                                        const Lighting& lighting);

/// What is left out of every object alike, and of the scene as a whole. `shadows`: asked for.
std::vector<LeftOut> left_out_of_scene(const PreparedScene& scene, bool shadows);

/// Objects that have the same left out, in the order of the first of each.
struct ObjectClass {
  std::vector<std::size_t> objects;
  std::vector<LeftOut> left_out;
};
std::vector<ObjectClass> object_classes(const PreparedScene& scene, const Lighting& lighting);

/// Index of the first instance of every object; instance_count() where there is none.
std::vector<std::size_t> first_instances(const PreparedScene& scene);
/// The object's name; a group's is made of its size.
std::string object_name(const PreparedScene& scene, std::size_t object);
/// "beech", "beech and 3 more".
std::string class_name(const PreparedScene& scene, const ObjectClass& one);

}  // namespace mirage
