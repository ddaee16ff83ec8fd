#include "client/draw/impostor_pass.h"

#include <algorithm>
#include <cstddef>
#include <tuple>

#include "client/draw/drawing.h"
#include "client/draw/entangled.h"
#include "client/draw/relief_instance.h"
#include "client/draw/tints.h"
#include "client/hold/tile_cache.h"
#include "protocol/model/need_mask.h"
#include "shaders/gl/view_depth.h"

namespace mirage {
namespace {

/// Per-instance attributes of impostor.vert, locations 2 to 11 and 13 to 15.
struct ImpostorInstance {
  glm::vec4 rotation, center_scale, right_distance, up_plane, window, atlas, depth, box_min,
      box_max, center;
  WornShadow shadow;
};
static_assert(sizeof(ImpostorInstance) == 208);
// Attribute of the proxy's vertices, among those of instances.
constexpr GLuint kParallaxLocation = 12;

// Opacity from which an object counts as solid. Below 1 - kSolid, nothing of it is seen.
constexpr float kSolid = 254.0f / 255.0f;
/// A tile that fades in lies on top of the one it replaces.
constexpr float kFadeBias = 0.002f;

glm::vec4 rotation_of(const InstanceView& view) {
  const glm::quat& q = view.world_from_object.rotation;
  return {q.x, q.y, q.z, q.w};
}

glm::vec4 center_scale_of(const InstanceView& view, const Camera& camera) {
  return {glm::vec3(view.center - camera.pose.eye), view.world_from_object.scale};
}

ImpostorInstance instance_data(const DrawnImpostor& drawn, const Camera& camera,
                               const SceneView& scene) {
  const InstanceView& view = scene.instances[drawn.instance];
  const ObjectDescription& object = scene.objects[view.object];
  const TileRecord& tile = *drawn.tile;
  const Capture& capture = tile.capture;
  const double per_texel = 2.0 * capture.half_tangent / capture.edge;
  const double left = tile.crop.x * per_texel - capture.half_tangent;
  const double top = capture.half_tangent - tile.crop.y * per_texel;
  ImpostorInstance out;
  out.rotation = rotation_of(view);
  out.center_scale = center_scale_of(view, camera);
  out.right_distance = glm::vec4(glm::vec3(capture.basis.right), capture.distance);
  out.up_plane = glm::vec4(glm::vec3(capture.basis.up), tile.measure.plane_depth);
  out.window = {left, top, left + tile.crop.w * per_texel, top - tile.crop.h * per_texel};
  out.atlas = {tile.slot.x + 1, tile.slot.y + 1, 1.0 / per_texel, -1.0 / per_texel};
  out.depth = {tile.depth_code.near_depth, tile.depth_code.far_depth, tile.slot.layer, drawn.fade};
  out.box_min = glm::vec4(object.box_min, drawn.fade < 1 ? kFadeBias : 0.0f);
  const double slack = capture.depth_slack(tile.measure.depth_max);
  out.box_max = glm::vec4(object.box_max, slack);
  out.center = glm::vec4(object.center, tile.measure.depth_min);
  out.shadow = worn_shadow(drawn);
  return out;
}

/// True if one instanced call can draw both.
bool drawn_alike(const DrawnImpostor& a, const DrawnImpostor& b) {
  const bool own_proxy = a.method == DrawMethod::kHull || a.method == DrawMethod::kWarp;
  return a.method == b.method && a.tile->relit == b.tile->relit &&
         a.tile->layered() == b.tile->layered() && (!own_proxy || a.tile->object == b.tile->object);
}

struct MethodShader {
  DrawMethod method;
  std::vector<std::string> defines;
};
const MethodShader kShaders[] = {
    {DrawMethod::kQuad, {"PROXY_QUAD", "METHOD_PROJECT", "QUAD_MARGIN 0.0"}},
    {DrawMethod::kCuboid, {"PROXY_CUBOID", "METHOD_PROJECT"}},
    {DrawMethod::kHull, {"PROXY_HULL", "METHOD_PROJECT"}},
    {DrawMethod::kWarp, {"PROXY_HULL", "METHOD_WARP"}},
};

}  // namespace

Result<gl::Program> ImpostorPass::make_program(const char* name, std::vector<std::string> defines,
                                               const Variant& v) {
  if (v.fog) defines.emplace_back("FOG");
  const std::string file = std::string("impostor/") + name;
  return gl::Program::create(file + ".vert", file + ".frag", defines);
}

Result<ImpostorPass::Programs> ImpostorPass::make_programs(const Variant& v) const {
  std::vector<std::string> worn;  // defines for shadows on tiles
  if (v.shadows) worn.emplace_back("SHADOW");
  const auto relit_from = [&](std::vector<std::string> defines) {
    defines.emplace_back("RELIT");
    if (v.probe) defines.emplace_back("PROBE");
    return defines;
  };
  const auto make = [&](const char* name, std::vector<std::string> defines) {
    return make_program(name, std::move(defines), v);
  };
  Programs out;
  for (const MethodShader& shader : kShaders) {
    if (flat_.count(shader.method) == 0) continue;
    for (const bool relit : {false, true}) {
      std::vector<std::string> defines = shader.defines;
      defines.insert(defines.end(), worn.begin(), worn.end());
      if (relit) defines = relit_from(std::move(defines));
      Result<gl::Program> program = make("impostor", defines);
      if (!program) return program.error();
      out.flat.emplace(std::pair(shader.method, relit), program.take());
    }
  }
  Result<gl::Program> relief = make("relief", worn), relit = make("relief", relit_from(worn));
  Result<gl::Program> placeholder = make("placeholder", {});
  for (const Result<gl::Program>* program : {&relief, &relit, &placeholder}) {
    if (!*program) return program->error();
  }
  out.relief = relief.take();
  out.relit_relief = relit.take();
  out.placeholder = placeholder.take();
  return out;
}

Result<ImpostorPass::Programs> ImpostorPass::make_tint_programs() const {
  Programs out;
  for (const MethodShader& shader : kShaders) {
    if (flat_.count(shader.method) == 0) continue;
    std::vector<std::string> defines = shader.defines;
    defines.emplace_back("TINT");
    Result<gl::Program> program = make_program("impostor", std::move(defines), {});
    if (!program) return program.error();
    out.flat.emplace(std::pair(shader.method, false), program.take());
  }
  Result<gl::Program> relief = make_program("relief", {"TINT"}, {});
  Result<gl::Program> layered = make_program("relief", {"LAYERED", "TINT"}, {});
  Result<gl::Program> placeholder = make_program("placeholder", {"TINT"}, {});
  for (const Result<gl::Program>* program : {&relief, &layered, &placeholder}) {
    if (!*program) return program->error();
  }
  out.relief = relief.take();
  out.layered_relief = layered.take();
  out.placeholder = placeholder.take();
  return out;
}

Result<ImpostorPass> ImpostorPass::create(int atlas_edge, int atlas_layers,
                                          std::set<DrawMethod> flat) {
  ImpostorPass pass;
  pass.flat_ = std::move(flat);
  Result<Programs> made = pass.make_programs({});
  if (!made) return made.error();
  pass.programs_ = made.take();
  Result<ImpostorAtlas> atlas = ImpostorAtlas::create(atlas_edge, atlas_layers);
  if (!atlas) return atlas.error();
  pass.atlas_ = atlas.take();
  pass.instances_ = gl::Buffer::create();
  std::vector<ProxyVertex> quad;
  for (const auto& [x, y] : {std::pair{0, 0}, {1, 0}, {1, 1}, {0, 0}, {1, 1}, {0, 1}}) {
    quad.push_back({glm::vec3(x, y, 0), glm::vec3(0, 0, 1), 0});
  }
  pass.quad_ = make_proxy(quad);
  pass.cube_ = make_proxy(cube_triangles(0));
  return pass;
}

ImpostorPass::Proxy ImpostorPass::make_proxy(const std::vector<ProxyVertex>& data) {
  Proxy proxy;
  proxy.vao = gl::VertexArray::create();
  proxy.vertices = gl::Buffer::create();
  proxy.vertex_count = static_cast<int>(data.size());
  glBindVertexArray(proxy.vao.id());
  glBindBuffer(GL_ARRAY_BUFFER, proxy.vertices.id());
  glBufferData(GL_ARRAY_BUFFER, static_cast<GLsizeiptr>(data.size() * sizeof(ProxyVertex)),
               data.data(), GL_STATIC_DRAW);
  constexpr GLsizei kStride = sizeof(ProxyVertex);
  glEnableVertexAttribArray(0);
  glVertexAttribPointer(0, 3, GL_FLOAT, GL_FALSE, kStride, nullptr);
  glEnableVertexAttribArray(1);
  glVertexAttribPointer(1, 3, GL_FLOAT, GL_FALSE, kStride,
                        reinterpret_cast<const void*>(offsetof(ProxyVertex, normal)));
  glEnableVertexAttribArray(12);
  glVertexAttribPointer(12, 1, GL_FLOAT, GL_FALSE, kStride,
                        reinterpret_cast<const void*>(offsetof(ProxyVertex, parallax)));
  glBindVertexArray(0);
  return proxy;
}

Result<void> ImpostorPass::upload(const TileRecord& record, const AtlasPlanes& planes) {
  if (record.layered() && !programs_.layered_relief) {
    std::vector<std::string> defines = {"LAYERED"};
    if (variant_.shadows) defines.emplace_back("SHADOW");
    Result<gl::Program> made = make_program("relief", std::move(defines), variant_);
    if (!made) return made.error();
    programs_.layered_relief = made.take();
  }
  return atlas_.upload(record, planes);
}

Result<void> ImpostorPass::reset(const SceneView& scene) {
  hulls_.clear();
  warp_proxies_.clear();
  fog_color_ = scene.environment.horizon;
  fog_density_ = scene.environment.fog_density;
  neutral_ = scene.environment.tone == ToneCurve::kNeutral;
  const Variant wanted{fog_density_ > 0, scene.shadows, scene.probe != nullptr};
  const auto bits = [](const Variant& v) { return std::tie(v.fog, v.shadows, v.probe); };
  if (bits(wanted) == bits(variant_)) return {};
  Result<Programs> made = make_programs(wanted);
  if (!made) return made.error();
  programs_ = made.take();
  variant_ = wanted;
  return {};
}

const ImpostorPass::Proxy& ImpostorPass::hull(const SceneView& scene, std::uint32_t object) {
  const auto [at, is_new] = hulls_.try_emplace(object);
  if (is_new) at->second = make_proxy(hull_triangles(scene.objects[object].hull));
  return at->second;
}

const ImpostorPass::Proxy& ImpostorPass::warp_proxy(const SceneView& scene, std::uint32_t object) {
  const auto [at, is_new] = warp_proxies_.try_emplace(object);
  if (is_new) at->second = make_proxy(warp_triangles(scene.objects[object]));
  return at->second;
}

template <typename InstanceT>
void ImpostorPass::draw_instances(const Proxy& proxy, const std::vector<InstanceT>& instances,
                                  bool cull) {
  if (instances.empty() || proxy.vertex_count == 0) return;
  glBindVertexArray(proxy.vao.id());
  glBindBuffer(GL_ARRAY_BUFFER, instances_.id());
  glBufferData(GL_ARRAY_BUFFER, static_cast<GLsizeiptr>(instances.size() * sizeof(InstanceT)),
               instances.data(), GL_STREAM_DRAW);
  for (GLuint i = 0; i < sizeof(InstanceT) / sizeof(glm::vec4); ++i) {
    const GLuint location = 2 + i < kParallaxLocation ? 2 + i : 3 + i;
    glEnableVertexAttribArray(location);
    glVertexAttribDivisor(location, 1);
    glVertexAttribPointer(location, 4, GL_FLOAT, GL_FALSE, sizeof(InstanceT),
                          reinterpret_cast<const void*>(i * sizeof(glm::vec4)));
  }
  (cull ? glEnable : glDisable)(GL_CULL_FACE);
  glDrawArraysInstanced(GL_TRIANGLES, 0, proxy.vertex_count,
                        static_cast<GLsizei>(instances.size()));
  ++draw_calls_;
}

void ImpostorPass::use_atlas(gl::Program& program, const Drawing& d, bool relit) {
  const Camera& camera = d.camera;
  program.use();
  program.set("u_clip_from_relative", camera.clip_from_relative(d.mapping));
  program.set("u_depth_window", glm::vec2(camera.window_depth(d.mapping)));
  program.set("u_depth_of_w", static_cast<float>(camera.depth_of_w()));
  program.set("u_near", static_cast<float>(camera.near_for(d.mapping)));
  program.set("u_fog_color", fog_color_);
  program.set("u_fog_density", fog_density_);
  program.set("u_color", 0);
  program.set("u_depth", 1);
  atlas_.bind(relit);
  if (variant_.shadows && !tints_) {
    program.set("u_shadow", 4);
    program.set("u_shadow_tint", shadow_tint_);
    glActiveTexture(GL_TEXTURE4);
    glBindTexture(GL_TEXTURE_2D_ARRAY, shadow_atlas_);
  }
  if (!relit) return;
  program.set("u_surface", 3);
  program.set("u_ambient", lights_.ambient);
  program.set("u_neutral", neutral_ ? 1 : 0);
  program.set("u_light_count", lights_.count);
  program.set("u_lights", lights_.lights);
  if (probe_) probe_->use(program, lights_.probe);
}

ImpostorPass::Fragments ImpostorPass::fragments_of(const DrawnImpostor& drawn,
                                                   const SceneView& scene, bool solid) const {
  const ObjectDescription& object = scene.objects[scene.instances[drawn.instance].object];
  const bool soft_within = object.group || object.part || (object.needs & kNeedBlend);
  const bool apart = std::binary_search(entangled_.begin(), entangled_.end(), drawn.instance) ||
                     (soft_within && drawn.method != DrawMethod::kDepth);
  if (!apart) return Fragments::kAll;
  return solid ? Fragments::kSolid : Fragments::kSoft;
}

void ImpostorPass::draw_relief(const Drawing& d, const DrawnImpostors& run, Fragments fragments) {
  const TileRecord& tile = *run[0]->tile;
  std::vector<ReliefInstance> instances;
  for (const DrawnImpostor* drawn : run) {
    instances.push_back(relief_instance(*drawn, d.camera, d.scene));
  }
  const bool relit = tile.relit && !tints_;
  gl::Program& program = relit            ? programs().relit_relief
                         : tile.layered() ? programs().layered_relief
                                          : programs().relief;
  use_atlas(program, d, relit);
  program.set("u_tint", tint_of(*run[0], d.list));
  program.set("u_fragments", static_cast<int>(fragments));
  glCullFace(GL_FRONT);  // far faces of the proxies: each pixel once, even with the eye inside
  draw_instances(cube_, instances, true);
  glCullFace(GL_BACK);
}

void ImpostorPass::draw_flat(const Drawing& d, const DrawnImpostors& run, Fragments fragments) {
  const DrawMethod method = run[0]->method;
  const TileRecord& tile = *run[0]->tile;
  std::vector<ImpostorInstance> instances;
  for (const DrawnImpostor* drawn : run) {
    instances.push_back(instance_data(*drawn, d.camera, d.scene));
  }
  const bool relit = tile.relit && !tints_;
  gl::Program& program = programs().flat.at({method, relit});
  use_atlas(program, d, relit);
  program.set("u_tint", tint_of(*run[0], d.list));
  program.set("u_fragments", static_cast<int>(fragments));
  program.set("u_forward", glm::vec3(d.camera.forward()));
  const Proxy& proxy = method == DrawMethod::kQuad   ? quad_
                       : method == DrawMethod::kHull ? hull(d.scene, tile.object)
                       : method == DrawMethod::kWarp ? warp_proxy(d.scene, tile.object)
                                                     : cube_;
  draw_instances(proxy, instances, method != DrawMethod::kQuad);
}

void ImpostorPass::draw_runs(const Drawing& d, bool solid) {
  DrawnImpostors run;
  const auto draw_run = [&] {
    if (run.empty()) return;
    const Fragments fragments = fragments_of(*run[0], d.scene, solid);
    glDepthMask(fragments != Fragments::kSoft);
    if (run[0]->method == DrawMethod::kDepth) {
      draw_relief(d, run, fragments);
    } else {
      draw_flat(d, run, fragments);
    }
    run.clear();
  };
  for (const DrawnImpostor& drawn : d.list.impostors) {
    const Fragments fragments = fragments_of(drawn, d.scene, solid);
    if (solid && fragments == Fragments::kAll) continue;
    const bool alike = !run.empty() && drawn_alike(*run[0], drawn) &&
                       fragments_of(*run[0], d.scene, solid) == fragments &&
                       tint_of(*run[0], d.list) == tint_of(drawn, d.list);
    if (!alike) draw_run();
    run.push_back(&drawn);
  }
  draw_run();
  glDepthMask(GL_TRUE);
}

void ImpostorPass::draw_placeholders(const Drawing& d, bool solid) {
  if (d.list.placeholders.empty()) return;
  std::map<std::uint32_t, std::vector<ImpostorInstance>> by_object;
  for (const DrawnPlaceholder& drawn : d.list.placeholders) {
    if (drawn.covered) continue;
    const InstanceView& view = d.scene.instances[drawn.instance];
    const ObjectDescription& object = d.scene.objects[view.object];
    if ((object.opacity >= kSolid) != solid || object.opacity < 1 - kSolid) continue;
    ImpostorInstance data{};
    data.rotation = rotation_of(view);
    data.center_scale = center_scale_of(view, d.camera);
    const bool lit = object.needs & kNeedLighting;
    const float opacity = solid ? 1 : object.opacity;
    data.right_distance = glm::vec4(object.mean_color * (lit ? placeholder_light_ : glm::vec3(1)),
                                    object.part ? -opacity : opacity);
    data.center = glm::vec4(object.center, 0);
    by_object[view.object].push_back(data);
  }
  gl::Program& program = programs().placeholder;
  program.use();
  if (tints_) program.set("u_tint", tints_->placeholders);
  program.set("u_clip_from_relative", d.camera.clip_from_relative(d.mapping));
  program.set("u_fog_color", fog_color_);
  program.set("u_fog_density", fog_density_);
  for (const auto& [object, instances] : by_object) {
    // A part of something that surrounds the eye, such as ground, is drawn by its far sides. The
    // near sides of its box would hide the things that stand on it.
    if (d.scene.objects[object].part) glCullFace(GL_FRONT);
    draw_instances(hull(d.scene, object), instances, true);
    glCullFace(GL_BACK);
  }
}

void ImpostorPass::draw(const Drawing& d, GLuint shadow_atlas, const gl::ProbeMap* probe) {
  probe_ = probe;
  // Placeholders and shadows use one colour for the light, so the probe counts as its mean.
  Lighting mean = d.lighting;
  if (d.scene.probe) mean.ambient += d.scene.probe->irradiance[0] * mean.probe.strength;
  placeholder_light_ = mean.ambient;
  for (const Light& l : mean.lights) {
    if (l.kind == LightKind::kDirectional) placeholder_light_ += 0.3f * l.color;
  }
  shadow_atlas_ = shadow_atlas;
  shadow_tint_ = shadow_tint(mean);
  lights_ = gl::light_block(d.lighting, d.camera.pose.eye);
  if (edges_last_) entangled_ = entangled(d.list.impostors, d.scene);
  draw_list(d);
}

Result<void> ImpostorPass::draw_tints(const Drawing& d, const Tints& tints) {
  if (!tint_programs_.placeholder) {
    Result<Programs> made = make_tint_programs();
    if (!made) return made.error();
    tint_programs_ = made.take();
  }
  tints_ = &tints;
  draw_list(d);
  tints_ = nullptr;
  return {};
}

glm::vec4 ImpostorPass::tint_of(const DrawnImpostor& drawn, const DrawList& list) const {
  return tints_ ? tints_->impostors[static_cast<std::size_t>(&drawn - list.impostors.data())]
                : glm::vec4(0);
}

void ImpostorPass::draw_list(const Drawing& d) {
  glEnable(GL_DEPTH_TEST);
  glDepthFunc(gl::nearer_or_equal(d.mapping));
  glDisable(GL_BLEND);
  draw_placeholders(d, true);
  draw_runs(d, true);
  if (!tints_) glEnable(GL_BLEND);  // a tint of 0 would leave what it hides
  glBlendFunc(GL_ONE, GL_ONE_MINUS_SRC_ALPHA);
  glDepthMask(GL_FALSE);
  draw_placeholders(d, false);
  glDepthMask(GL_TRUE);
  draw_runs(d, false);
  glBindVertexArray(0);
  glDisable(GL_BLEND);
  glDisable(GL_CULL_FACE);
}

}  // namespace mirage
