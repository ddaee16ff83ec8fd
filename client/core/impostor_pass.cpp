#include "client/core/impostor_pass.h"

#include <algorithm>
#include <cstddef>
#include <tuple>

#include "client/core/relief_instance.h"
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
constexpr GLuint kParallaxLocation = 12;  // of the proxy's vertices, among those of instances

/// A tile fading in lies on top of the one it replaces.
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
  const double slack = tile.depth_code.quantum() + capture.texel_width(tile.measure.depth_max);
  out.box_max = glm::vec4(object.box_max, slack);
  out.center = glm::vec4(object.center, tile.measure.depth_min);
  out.shadow = worn_shadow(drawn);
  return out;
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

Result<void> ImpostorPass::make_programs(const Variant& v) {
  std::vector<std::string> worn;  // of what has a tile, and shadows on it
  if (v.shadows) worn.emplace_back("SHADOW");
  const auto relit_from = [&](std::vector<std::string> defines) {
    defines.emplace_back("RELIT");
    if (v.probe) defines.emplace_back("PROBE");
    return defines;
  };
  const auto make = [&](const char* name, std::vector<std::string> defines) {
    return make_program(name, std::move(defines), v);
  };
  std::map<std::pair<DrawMethod, bool>, gl::Program> programs;
  for (const MethodShader& shader : kShaders) {
    for (const bool relit : {false, true}) {
      std::vector<std::string> defines = shader.defines;
      defines.insert(defines.end(), worn.begin(), worn.end());
      if (relit) defines = relit_from(std::move(defines));
      Result<gl::Program> program = make("impostor", defines);
      if (!program) return program.error();
      programs.emplace(std::pair(shader.method, relit), program.take());
    }
  }
  std::vector<std::string> worn_relit = relit_from(worn), worn_merged = worn;
  worn_merged.emplace_back("MERGED");
  Result<gl::Program> relief = make("relief", worn), relit = make("relief", worn_relit);
  Result<gl::Program> merged = make("relief", worn_merged), placeholder = make("placeholder", {});
  for (const Result<gl::Program>* program : {&relief, &relit, &merged, &placeholder}) {
    if (!*program) return program->error();
  }
  layered_relief_ = gl::Program();
  programs_ = std::move(programs);
  relief_ = relief.take();
  relit_relief_ = relit.take();
  merged_ = merged.take();
  placeholder_ = placeholder.take();
  variant_ = v;
  return {};
}

Result<ImpostorPass> ImpostorPass::create(int atlas_edge, int atlas_layers) {
  ImpostorPass pass;
  if (Result<void> made = pass.make_programs({}); !made) return made.error();
  Result<ImpostorAtlas> atlas = ImpostorAtlas::create(atlas_edge, atlas_layers);
  if (!atlas) return atlas.error();
  pass.atlas_ = atlas.take();
  pass.instances_ = gl::Buffer::create();
  pass.tile_rows_ = gl::Texture::create();
  glBindTexture(GL_TEXTURE_2D, pass.tile_rows_.id());
  glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MIN_FILTER, GL_NEAREST);
  glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MAG_FILTER, GL_NEAREST);
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

Result<void> ImpostorPass::upload(const TileRecord& record, const TilePixels& pixels) {
  if (record.layered() && !layered_relief_) {
    std::vector<std::string> defines = {"LAYERED"};
    if (variant_.shadows) defines.emplace_back("SHADOW");
    Result<gl::Program> made = make_program("relief", std::move(defines), variant_);
    if (!made) return made.error();
    layered_relief_ = made.take();
  }
  return atlas_.upload(record, pixels);
}

Result<void> ImpostorPass::reset(const SceneView& scene) {
  hulls_.clear();
  warp_proxies_.clear();
  fog_color_ = scene.environment.horizon;
  fog_density_ = scene.environment.fog_density;
  const Variant wanted{fog_density_ > 0, scene.shadows, scene.probe != nullptr};
  const auto bits = [](const Variant& v) { return std::tie(v.fog, v.shadows, v.probe); };
  return bits(wanted) == bits(variant_) ? Result<void>{} : make_programs(wanted);
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

void ImpostorPass::use_atlas(gl::Program& program, const Camera& camera, bool relit) {
  program.use();
  program.set("u_clip_from_relative", camera.clip_from_relative(mapping_));
  program.set("u_depth_window", glm::vec2(camera.window_depth(mapping_)));
  program.set("u_near", static_cast<float>(camera.near_for(mapping_)));
  program.set("u_fog_color", fog_color_);
  program.set("u_fog_density", fog_density_);
  program.set("u_color", 0);
  program.set("u_depth", 1);
  program.set("u_tiles", 2);
  atlas_.bind(relit);
  if (variant_.shadows) {
    program.set("u_shadow", 4);
    program.set("u_shadow_tint", shadow_tint_);
    glActiveTexture(GL_TEXTURE4);
    glBindTexture(GL_TEXTURE_2D_ARRAY, shadow_atlas_);
  }
  if (!relit) return;
  program.set("u_surface", 3);
  program.set("u_ambient", lights_.ambient);
  program.set("u_light_count", lights_.count);
  program.set("u_lights", lights_.lights);
  if (probe_) probe_->use(program, lights_.probe);
}

void ImpostorPass::draw_relief(const Camera& camera, const SceneView& scene, const DrawList& list) {
  std::vector<ReliefInstance> run, relit, merged;
  std::vector<glm::vec4> rows;
  // The proxies' far faces: each pixel once, also with the eye inside.
  glCullFace(GL_FRONT);
  // Those in one layer and in two together back to front, by runs: soft edges lie over what is
  // behind.
  bool in_layers = false;
  const auto draw_run = [&] {
    if (run.empty()) return;
    use_atlas(in_layers ? layered_relief_ : relief_, camera, false);
    draw_instances(cube_, run, true);
    run.clear();
  };
  for (const DrawnImpostor& drawn : list.impostors) {
    if (drawn.method != DrawMethod::kDepth) continue;
    // Merging takes finished colours: a relit tile is drawn alone.
    if (drawn.tile->relit) {
      relit.push_back(relief_instance(drawn, camera, scene, 0));
      continue;
    }
    if (!drawn.neighbours[0]) {
      if (drawn.tile->layered() != in_layers) draw_run();
      in_layers = drawn.tile->layered();
      run.push_back(relief_instance(drawn, camera, scene, 0));
      continue;
    }
    merged.push_back(relief_instance(drawn, camera, scene, static_cast<int>(merged.size())));
    append_relief_row(drawn, camera, scene, rows);
  }
  draw_run();
  if (!relit.empty()) {
    use_atlas(relit_relief_, camera, true);
    draw_instances(cube_, relit, true);
  }
  if (!merged.empty()) {
    use_atlas(merged_, camera, false);
    glActiveTexture(GL_TEXTURE2);
    glBindTexture(GL_TEXTURE_2D, tile_rows_.id());
    glTexImage2D(GL_TEXTURE_2D, 0, GL_RGBA32F, kReliefRowTexels,
                 static_cast<GLsizei>(merged.size()), 0, GL_RGBA, GL_FLOAT, rows.data());
    draw_instances(cube_, merged, true);
  }
  glCullFace(GL_BACK);
}

void ImpostorPass::draw_flat(const Camera& camera, const SceneView& scene,
                             const DrawnImpostors& drawn, bool soft) {
  for (const MethodShader& shader : kShaders) {
    for (const bool relit : {false, true}) {
      draw_method(camera, scene, drawn, shader.method, relit, soft);
    }
  }
}

void ImpostorPass::draw_method(const Camera& camera, const SceneView& scene,
                               const DrawnImpostors& impostors, DrawMethod method, bool relit,
                               bool soft) {
  std::vector<ImpostorInstance> all;
  std::map<std::uint32_t, std::vector<ImpostorInstance>> by_object;
  for (const DrawnImpostor* drawn : impostors) {
    if (drawn->method != method || drawn->tile->relit != relit) continue;
    if (method == DrawMethod::kHull || method == DrawMethod::kWarp) {
      by_object[drawn->tile->object].push_back(instance_data(*drawn, camera, scene));
    } else {
      all.push_back(instance_data(*drawn, camera, scene));
    }
  }
  if (all.empty() && by_object.empty()) return;
  gl::Program& program = programs_.at({method, relit});
  use_atlas(program, camera, relit);
  program.set("u_soft", soft ? 1 : 0);
  program.set("u_forward", glm::vec3(camera.forward()));
  const bool quad = method == DrawMethod::kQuad;
  draw_instances(quad ? quad_ : cube_, all, !quad);
  for (const auto& [object, instances] : by_object) {
    const bool warp = method == DrawMethod::kWarp;
    draw_instances(warp ? warp_proxy(scene, object) : hull(scene, object), instances, true);
  }
}

void ImpostorPass::draw_placeholders(const Camera& camera, const SceneView& scene,
                                     const DrawList& list, const Lighting& lighting) {
  if (list.placeholders.empty()) return;
  glm::vec3 light = lighting.ambient;
  for (const Light& l : lighting.lights) {
    if (l.kind == LightKind::kDirectional) light += 0.3f * l.color;
  }
  std::map<std::uint32_t, std::vector<ImpostorInstance>> by_object;
  for (const DrawnPlaceholder& drawn : list.placeholders) {
    if (drawn.covered) continue;
    const InstanceView& view = scene.instances[drawn.instance];
    const ObjectDescription& object = scene.objects[view.object];
    ImpostorInstance data{};
    data.rotation = rotation_of(view);
    data.center_scale = center_scale_of(view, camera);
    const bool lit = object.needs & kNeedLighting;
    data.right_distance =
        glm::vec4(object.mean_color * (lit ? light : glm::vec3(1)), object.part ? -1 : 1);
    data.center = glm::vec4(object.center, 0);
    by_object[view.object].push_back(data);
  }
  placeholder_.use();
  placeholder_.set("u_clip_from_relative", camera.clip_from_relative(mapping_));
  placeholder_.set("u_fog_color", fog_color_);
  placeholder_.set("u_fog_density", fog_density_);
  for (const auto& [object, instances] : by_object) {
    // Of a part of what one is in, such as ground, the far sides: the near ones of its box stand
    // before what is on it.
    if (scene.objects[object].part) glCullFace(GL_FRONT);
    draw_instances(hull(scene, object), instances, true);
    glCullFace(GL_BACK);
  }
}

void ImpostorPass::draw(const Camera& camera, DepthMapping mapping, const SceneView& scene,
                        const DrawList& list, const Lighting& lighting, GLuint shadow_atlas,
                        const gl::ProbeMap* probe) {
  probe_ = probe;
  // Where one colour has to do, the probe is what it sends on the mean.
  Lighting mean = lighting;
  if (scene.probe) mean.ambient += scene.probe->irradiance[0] * lighting.probe.strength;
  mapping_ = mapping;
  shadow_atlas_ = shadow_atlas;
  shadow_tint_ = shadow_tint(mean);
  glEnable(GL_DEPTH_TEST);
  glDepthFunc(gl::nearer_or_equal(mapping_));
  glDisable(GL_BLEND);
  lights_ = gl::light_block(lighting, camera.pose.eye);
  draw_placeholders(camera, scene, list, mean);
  const BlendOrder order = blend_order(list.impostors, scene, camera.pose.eye);
  DrawnImpostors flat = order.under_relief;
  flat.insert(flat.end(), order.over_relief.begin(), order.over_relief.end());
  draw_flat(camera, scene, flat, false);
  glEnable(GL_BLEND);
  glBlendFunc(GL_ONE, GL_ONE_MINUS_SRC_ALPHA);
  glDepthMask(GL_FALSE);
  draw_flat(camera, scene, order.under_relief, true);
  glDepthMask(GL_TRUE);
  draw_relief(camera, scene, list);
  glDepthMask(GL_FALSE);
  draw_flat(camera, scene, order.over_relief, true);
  glDepthMask(GL_TRUE);
  glBindVertexArray(0);
  glDisable(GL_BLEND);
  glDisable(GL_CULL_FACE);
}

}  // namespace mirage
