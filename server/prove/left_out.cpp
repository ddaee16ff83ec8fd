#include "server/prove/left_out.h"

#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <map>
#include <set>

#include "protocol/impostor/instance_group.h"
#include "protocol/impostor/lighting_state.h"
#include "protocol/impostor/object_proxy.h"
#include "protocol/impostor/sun_frame.h"
#include "protocol/model/need_rules.h"
#include "server/prepare/grouping.h"
#include "server/prepare/prepared_scene.h"

namespace mirage {
namespace {

struct AbsentNeed {
  Need need;
  NeedRule rule;
  const char* what;
  const char* why;
};
// Texts for needs about which no material finding says something more exact.
constexpr AbsentNeed kAbsent[] = {
    {kNeedBlend, NeedRule::kBlending, "blending", "no material blends"},
    {kNeedAlphaMask, NeedRule::kBlending, "alpha test", "no material tests alpha"},
    {kNeedBaseColorMap, NeedRule::kSolidColor, "base colour map", "no material has one"},
    {kNeedVertexColor, NeedRule::kAttributes, "vertex colours", "white on every vertex"},
    {kNeedUv1, NeedRule::kAttributes, "second texture coordinates", "no map reads them"},
    {kNeedMetalRoughMap, NeedRule::kMaps, "metal-rough map", "no material has one"},
    {kNeedNormalMap, NeedRule::kMaps, "normal map", "no material has one"},
    {kNeedOcclusionMap, NeedRule::kMaps, "occlusion map", "no material has one"},
    {kNeedEmissiveMap, NeedRule::kEmission, "emissive map", "no material has one"},
    {kNeedLighting, NeedRule::kLighting, "lighting, and the light in the key",
     "every material is unlit"},
};

std::set<std::uint32_t> materials_of(const PreparedScene& scene, std::size_t object) {
  std::set<std::uint32_t> out;
  const InstanceGroup* group = scene.group(object);
  const auto add = [&](std::size_t i) {
    for (const Primitive& p : scene.scene.objects[i].mesh.primitives) out.insert(p.material);
  };
  if (!group) {
    add(object);
    return out;
  }
  for (std::uint32_t i = 0; i < group->leaves; ++i) {
    add(scene.scene.instances[group->first_leaf + i].object);
  }
  return out;
}

// Adds the findings of the object's materials, equal ones once.
void add_material_findings(const PreparedScene& scene, std::size_t object,
                           std::vector<LeftOut>& out) {
  const auto add = [&](const std::vector<LeftOut>& found) {
    for (const LeftOut& one : found) {
      const auto same = [&](const LeftOut& o) { return o.what == one.what && o.why == one.why; };
      if (std::none_of(out.begin(), out.end(), same)) out.push_back(one);
    }
  };
  for (const std::uint32_t m : materials_of(scene, object)) add(scene.left_out.materials[m]);
  if (!scene.group(object)) add(scene.left_out.objects[object]);
}

void add_lights(const PreparedScene& scene, std::size_t object, std::size_t instance,
                const Lighting& lighting, std::vector<LeftOut>& out) {
  const auto described = scene.description(object);
  const ObjectDescription& o = *described;
  const Similarity placed = scene.instance(instance).world_from_object;
  std::size_t black = 0, far_off = 0;
  for (const Light& light : lighting.lights) {
    const bool is_black = light.color == glm::vec3(0);
    black += is_black ? 1 : 0;
    if (is_black) continue;
    Lighting alone;
    alone.lights = {light};
    far_off += object_lighting(alone, placed, o.center, o.radius).lights.empty() ? 1 : 0;
  }
  const std::size_t n = lighting.lights.size();
  if (black > 0) {
    out.push_back({NeedRule::kLights, fmt::format("{} of {} lights", black, n), "they are black"});
  }
  if (far_off > 0) {
    out.push_back({NeedRule::kLights, fmt::format("{} of {} lights", far_off, n),
                   "their range or cone ends before it"});
  }
}

}  // namespace

std::vector<std::size_t> first_instances(const PreparedScene& scene) {
  std::vector<std::size_t> out(scene.object_count(), scene.instance_count());
  for (std::size_t i = scene.instance_count(); i-- > 0;) out[scene.instance(i).object] = i;
  return out;
}

std::vector<LeftOut> left_out_of_object(const PreparedScene& scene, std::size_t object,
                                        const Lighting& lighting) {
  const auto described = scene.description(object);
  const ObjectDescription& o = *described;
  std::vector<LeftOut> out;
  add_material_findings(scene, object, out);
  const bool lit = (o.needs & kNeedLighting) != 0;
  for (const AbsentNeed& absent : kAbsent) {
    if (o.needs & absent.need) continue;
    const bool known = std::any_of(out.begin(), out.end(),
                                   [&](const LeftOut& one) { return one.what == absent.what; });
    // An unlit object needs no such lines: "no lighting" covers them.
    const bool of_light = absent.rule == NeedRule::kMaps || absent.rule == NeedRule::kEmission;
    if (!known && (lit || !of_light)) out.push_back({absent.rule, absent.what, absent.why});
  }
  const std::size_t instance = first_instances(scene)[object];
  if (lit && instance < scene.instance_count()) add_lights(scene, object, instance, lighting, out);
  const bool animated =
      object < scene.scene.objects.size() && scene.scene.objects[object].animation;
  if (!animated) out.push_back({NeedRule::kAnimation, "skinning, phases", "it does not move"});
  std::stable_sort(out.begin(), out.end(),
                   [](const LeftOut& a, const LeftOut& b) { return a.rule < b.rule; });
  return out;
}

std::vector<LeftOut> left_out_of_scene(const PreparedScene& scene, bool shadows) {
  std::vector<LeftOut> out;
  out.push_back({NeedRule::kLighting, "normals and material of a lit tile",
                 "its light is in its key, so nobody reads them"});
  out.push_back({NeedRule::kDepthBits, "16 of 24 depth bits",
                 "1/254 of an object's depth is within its bound"});
  out.push_back({NeedRule::kHdr, "float colour targets", "no shader writes more than 1"});
  out.push_back({NeedRule::kGray, "what red and blue share with green",
                 "of gray all of it: they are sent as differences"});
  out.push_back({NeedRule::kCrop, "texels outside the content's box", "they are empty"});
  if (!shadows || !scene.has_casters() || !sun_of(scene.scene.lighting)) {
    out.push_back({NeedRule::kShadows, "shadow passes and shadow tiles",
                   !shadows              ? "--shadows is off"
                   : scene.has_casters() ? "the scene's light has no sun"
                                         : "nothing casts any"});
  }
  if (const std::size_t equal = scene.left_out.equal_objects; equal > 0) {
    out.push_back({NeedRule::kInstances, fmt::format("{} objects", equal),
                   "they are others over again, to the last vertex"});
  }
  const LeftOutOfScene& left = scene.left_out;
  if (left.covered_instances + left.covered_triangles > 0) {
    out.push_back({NeedRule::kCovered,
                   fmt::format("{} instances, and sides of {} triangles of others",
                               left.covered_instances, left.covered_triangles),
                   "a later opaque surface lies exactly on them"});
  }
  std::size_t shared = 0;
  std::map<std::uint32_t, std::size_t> seen;
  for (const Instance& instance : scene.scene.instances) shared += seen[instance.object]++ > 0;
  if (shared > 0) {
    out.push_back({NeedRule::kInstances,
                   fmt::format("tiles and geometry of {} of {} instances", shared,
                               scene.scene.instances.size()),
                   "another shows the same object"});
  }
  out.push_back({NeedRule::kStillness, "rendering, asking and drawing while nothing changes",
                 "equal inputs give the picture that is there"});
  out.push_back({NeedRule::kInvisible, "asks for what is out of view or under half a pixel",
                 "it is not drawn"});
  out.push_back({NeedRule::kMips, "mip levels of tiles", "each is asked for at its size"});
  return out;
}

std::vector<ObjectClass> object_classes(const PreparedScene& scene, const Lighting& lighting) {
  std::vector<ObjectClass> out;
  std::map<std::string, std::size_t> known;
  for (std::size_t i = 0; i < scene.scene.objects.size(); ++i) {
    std::vector<LeftOut> left = left_out_of_object(scene, i, lighting);
    std::string text;
    for (const LeftOut& one : left) text += one.what + "\n" + one.why + "\n";
    const auto [at, is_new] = known.emplace(text, out.size());
    if (is_new) out.push_back({{}, std::move(left)});
    out[at->second].objects.push_back(i);
  }
  return out;
}

std::string object_name(const PreparedScene& scene, std::size_t object) {
  if (const InstanceGroup* group = scene.group(object)) {
    if (group->part != kNoGroup) {
      return "part of " + object_name(scene, scene.scene.instances[group->first_leaf].object);
    }
    return fmt::format("group of {}", group->leaves);
  }
  const std::string& name = scene.scene.objects[object].name;
  return name.empty() ? fmt::format("object {}", object) : name;
}

std::string class_name(const PreparedScene& scene, const ObjectClass& one) {
  const std::string first = object_name(scene, one.objects.front());
  if (one.objects.size() == 1) return first;
  return fmt::format("{} and {} more", first, one.objects.size() - 1);
}

}  // namespace mirage
