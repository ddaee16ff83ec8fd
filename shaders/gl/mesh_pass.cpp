#include "shaders/gl/mesh_pass.h"

#include <algorithm>
#include <cmath>
#include <cstddef>

#include "protocol/base/limits.h"
#include "shaders/gl/dialect.h"
#include "shaders/gl/mesh_variants.h"
#include "shaders/gl/paced_draw.h"
#include "shaders/gl/renderer.h"

namespace mirage::gl {
namespace {

constexpr int kFloorUnit = 6;      // free among the units of mesh.frag
constexpr int kFirstLobeUnit = 9;  // after the probe

GLint gl_wrap(Wrap wrap) {
  switch (wrap) {
    case Wrap::kClamp:
      return GL_CLAMP_TO_EDGE;
    case Wrap::kMirror:
      return GL_MIRRORED_REPEAT;
    case Wrap::kRepeat:
      break;
  }
  return GL_REPEAT;
}

void bind_texture(int unit, const TextureRef& ref, const GpuImages& images, GLint min_filter) {
  glActiveTexture(GL_TEXTURE0 + static_cast<GLenum>(unit));
  glBindTexture(GL_TEXTURE_2D, images.texture(ref.image));
  glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_WRAP_S, gl_wrap(ref.wrap_s));
  glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_WRAP_T, gl_wrap(ref.wrap_t));
  glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MAG_FILTER, ref.nearest ? GL_NEAREST : GL_LINEAR);
  glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MIN_FILTER, min_filter);
}

// KHR_texture_transform: translation * rotation * scale.
void put_uv_transform(const TextureRef& t, glm::vec4* out) {
  const float c = std::cos(t.rotation), s = std::sin(t.rotation);
  out[0] = {t.scale.x * c, t.scale.y * s, t.offset.x, t.uv_set == 1 ? 1.0f : 0.0f};
  out[1] = {-t.scale.x * s, t.scale.y * c, t.offset.y, 0.0f};
}

void add_light(LightBlock& block, LightKind kind, const glm::vec3& color, const glm::vec3& position,
               const glm::vec3& direction, const glm::vec3& range_and_cones) {
  if (block.lights.size() >= limits::kMaxLights * 4) return;
  block.lights.emplace_back(color, static_cast<float>(kind));
  block.lights.emplace_back(position, range_and_cones.x);
  block.lights.emplace_back(direction, range_and_cones.y);
  block.lights.emplace_back(range_and_cones.z, 0, 0, 0);
  ++block.count;
}

GLenum gl_mode(PrimitiveKind kind) {
  switch (kind) {
    case PrimitiveKind::kLines:
      return GL_LINES;
    case PrimitiveKind::kPoints:
      return GL_POINTS;
    case PrimitiveKind::kTriangles:
      break;
  }
  return GL_TRIANGLES;
}

}  // namespace

MeshInstance mesh_instance(const Similarity& m, const glm::dvec3& eye, std::uint32_t id) {
  MeshInstance out;
  out.rotation = {m.rotation.x, m.rotation.y, m.rotation.z, m.rotation.w};
  out.position_scale = glm::vec4(glm::vec3(m.position - eye), m.scale);
  out.id = id;
  return out;
}

LightBlock light_block(const ObjectLighting& lighting, const glm::vec3& eye) {
  LightBlock block;
  block.ambient = lighting.ambient;
  block.probe = lighting.probe;
  for (const ObjectLight& l : lighting.lights) {
    add_light(block, l.kind, l.color, l.position - eye, l.direction,
              {l.range, l.cos_inner, l.cos_outer});
  }
  return block;
}

LightBlock light_block(const Lighting& lighting, const glm::dvec3& eye) {
  LightBlock block;
  block.ambient = lighting.ambient;
  block.probe = lighting.probe;
  const Light* sun = sun_of(lighting);
  for (const Light& l : lighting.lights) {
    if (l.color == glm::vec3(0)) continue;
    if (&l == sun) block.sun = block.count;
    add_light(block, l.kind, l.color, glm::vec3(l.position - eye), l.direction,
              {l.range, l.cos_inner, l.cos_outer});
  }
  return block;
}

void MeshPass::force(NeedMask needs) {
  forced_ = needs;
  const auto one_texel = [](GLint format, glm::vec4 value) {
    Texture texture = Texture::create();
    glBindTexture(GL_TEXTURE_2D, texture.id());
    glTexImage2D(GL_TEXTURE_2D, 0, format, 1, 1, 0, GL_RGBA, GL_FLOAT, &value.x);
    return texture;
  };
  white_ = one_texel(GL_RGBA8, glm::vec4(1));
  black_probe_ = ProbeMap::black();
  // The map is 16-bit float because no 8-bit normal map is neutral: 127 and 128 both lean by 0.2
  // degrees.
  flat_ = one_texel(GL_RGBA16F, {0.5f, 0.5f, 1, 1});
  along_ = one_texel(GL_RGBA16F, {1, 0.5f, 1, 1});
}

std::vector<std::string> MeshPass::variants() const {
  std::vector<std::string> out;
  for (const auto& [needs, unused] : programs_) {
    std::string name;
    for (const std::string& define : variant_defines(needs)) {
      name += (name.empty() ? "" : " ") + define;
    }
    out.push_back(name);
  }
  return out;
}

Result<Program*> MeshPass::program(NeedMask needs, bool fade, Stage stage) {
  needs &= kShaderNeeds;
  if (forced_) needs |= (forced_ & kShaderNeeds) | kSwitches;
  if (shadow_ && (needs & kNeedLighting)) needs |= kShadow;
  if ((probe_ || forced_) && (needs & kNeedLighting)) needs |= kProbe;
  if (fog_density_ > 0) needs |= kFog;
  if (stage == Stage::kDepth) {
    needs = (needs & kNeedAlphaMask ? needs & (kDepthNeeds | kSwitches) : NeedMask{0}) | kDepthOnly;
  }
  if (stage == Stage::kTested) needs &= ~NeedMask{kNeedAlphaMask};
  if (of_blended())
    needs = (needs & (kNeedBaseColorMap | kNeedVertexColor | kSwitches)) | kDepthOnly;
  if (output_ == MeshOutput::kTint && stage != Stage::kDepth) {
    needs &= kNeedBaseColorMap | kNeedVertexColor | kNeedBlend | kNeedAlphaMask;
  }
  if (fade) needs |= kFade;
  const auto found = programs_.find(needs);
  if (found != programs_.end()) return &found->second;
  std::vector<std::string> defines = variant_defines(needs);
  if (output_ == MeshOutput::kShadow) defines.emplace_back("WRITE_DARKENED");
  if (output_ == MeshOutput::kId) defines.emplace_back("WRITE_ID");
  if (of_blended()) defines.emplace_back("SEEN");
  if (output_ == MeshOutput::kFront) defines.emplace_back("WRITE_ID");
  if (output_ == MeshOutput::kRange) defines.emplace_back("WRITE_RANGE");
  if (output_ == MeshOutput::kSurface) defines.emplace_back("WRITE_SURFACE");
  if (output_ == MeshOutput::kBehind) defines.emplace_back("BEHIND");
  if (output_ == MeshOutput::kClear) defines.emplace_back("CLEAR");
  if (output_ == MeshOutput::kTint) defines.emplace_back("TINT");
  Result<Program> made = Program::create("mesh/mesh.vert", "mesh/mesh.frag", defines);
  if (!made) return made.error();
  return &programs_.emplace(needs, made.take()).first->second;
}

Result<void> MeshPass::compile(NeedMask needs, bool fades) {
  for (const bool fade : {false, true}) {
    if (fade && !fades) continue;
    for (const Stage stage : stages(needs)) {
      if (Result<Program*> made = program(needs, fade, stage); !made) return made.error();
    }
  }
  return {};
}

Result<void> MeshPass::warm_up(const GpuMesh& mesh, const std::vector<Material>& materials,
                               bool fades) {
  for (const Primitive& p : mesh.primitives()) {
    const NeedMask needs = material_needs(materials[p.material], mesh.vertex_color());
    if (Result<void> made = compile(needs, fades); !made) return made;
  }
  return {};
}

void MeshPass::begin(const glm::mat4& clip_from_relative, const LightBlock& lights,
                     DepthMapping mapping) {
  clip_from_relative_ = clip_from_relative;
  nearer_ = output_ == MeshOutput::kClear ? GL_GREATER : nearer(mapping);
  lights_ = lights;
  if (!instance_buffer_) instance_buffer_ = Buffer::create();
  glEnable(GL_DEPTH_TEST);
  glDepthFunc(nearer_);
  glFrontFace(GL_CCW);
  glBlendFunc(GL_ONE, GL_ONE_MINUS_SRC_ALPHA);
  glBlendEquation(output_ == MeshOutput::kRange ? GL_MAX : GL_FUNC_ADD);
  if (forced_ & kNeedVertexColor) glVertexAttrib4f(5, 1, 1, 1, 1);  // for meshes without colours
  if (!samples_) samples_ = has_sample_shading();
  *samples_ ? prepare_points_and_samples() : let_shaders_size_points();
  glLineWidth(stroke_);  // the device uses the nearest width it can draw
}

void MeshPass::bind_instances(const MeshInstance* instances, std::size_t count) {
  glBindBuffer(GL_ARRAY_BUFFER, instance_buffer_.id());
  glBufferData(GL_ARRAY_BUFFER, static_cast<GLsizeiptr>(count * sizeof(MeshInstance)), instances,
               GL_STREAM_DRAW);
  constexpr GLsizei kStride = sizeof(MeshInstance);
  for (GLuint i = 6; i <= 9; ++i) {
    glEnableVertexAttribArray(i);
    glVertexAttribDivisor(i, 1);
  }
  glVertexAttribPointer(6, 4, GL_FLOAT, GL_FALSE, kStride, nullptr);
  glVertexAttribPointer(7, 4, GL_FLOAT, GL_FALSE, kStride,
                        reinterpret_cast<const void*>(offsetof(MeshInstance, position_scale)));
  glVertexAttribIPointer(8, 1, GL_UNSIGNED_INT, kStride,
                         reinterpret_cast<const void*>(offsetof(MeshInstance, id)));
  glVertexAttribPointer(9, 1, GL_FLOAT, GL_FALSE, kStride,
                        reinterpret_cast<const void*>(offsetof(MeshInstance, fade)));
}

void MeshPass::bind_material(Program& p, const Material& m, NeedMask needs, const GpuImages& images,
                             Stage stage) {
  p.set("u_base_color", m.base_color);
  p.set("u_emissive", m.emissive);
  p.set("u_factors", glm::vec4(m.metallic, m.roughness, m.normal_scale, m.occlusion_strength));
  p.set("u_alpha_cutoff", m.alpha_mode == AlphaMode::kMask ? m.alpha_cutoff : 0.0f);
  p.set("u_switches", glm::vec2(m.unlit, m.alpha_mode != AlphaMode::kBlend));
  const TextureRef* maps[5] = {&m.base_color_map, &m.metal_rough_map, &m.normal_map,
                               &m.occlusion_map, &m.emissive_map};
  const char* names[5] = {"u_base_color_map", "u_metal_rough_map", "u_normal_map",
                          "u_occlusion_map", "u_emissive_map"};
  const NeedMask bits[5] = {kNeedBaseColorMap, kNeedMetalRoughMap, kNeedNormalMap,
                            kNeedOcclusionMap, kNeedEmissiveMap};
  const bool lobes = (needs | forced_) & kLobeNeeds;
  std::vector<glm::vec4> transforms(lobes ? 2 * (5 + kLobeMaps) : 10, glm::vec4(0));
  for (int i = 0; i < 5; ++i) {
    if (!((needs | forced_) & bits[i])) continue;
    if (needs & bits[i]) {
      // The alpha test needs only one mip level, at half the price of two.
      bind_texture(i, *maps[i], images,
                   stage == Stage::kDepth ? GL_LINEAR_MIPMAP_NEAREST : GL_LINEAR_MIPMAP_LINEAR);
    } else {
      glActiveTexture(GL_TEXTURE0 + static_cast<GLenum>(i));
      glBindTexture(GL_TEXTURE_2D, bits[i] == kNeedNormalMap ? flat_.id() : white_.id());
    }
    p.set(names[i], i);
    put_uv_transform(*maps[i], &transforms[static_cast<std::size_t>(2 * i)]);
  }
  if (lobes) bind_lobes(p, m.lobes, needs, images, transforms);
  p.set("u_uv_transform", transforms);
}

const Texture& MeshPass::neutral_map(LobeMap which) const {
  if (which == LobeMap::kClearcoatNormal) return flat_;
  return which == LobeMap::kAnisotropy ? along_ : white_;
}

void MeshPass::bind_lobes(Program& p, const Lobes& l, NeedMask needs, const GpuImages& images,
                          std::vector<glm::vec4>& transforms) {
  // Schlick's f0 from the refractive index; exactly 0.04 for the usual index.
  const float ratio = (l.ior - 1) / (l.ior + 1);
  const float f0 = l.ior == 1.5f ? 0.04f : ratio * ratio;
  p.set("u_reflectance",
        glm::vec4(glm::min(f0 * l.specular_color, glm::vec3(1)) * l.specular, l.specular));
  p.set("u_clearcoat", glm::vec2(l.clearcoat, l.clearcoat_roughness));
  p.set("u_sheen", glm::vec4(l.sheen_color, l.sheen_roughness));
  p.set("u_backdrop", backdrop_);
  p.set("u_transmission", glm::vec4(l.volume_tint, l.transmission));
  p.set("u_anisotropy",
        glm::vec3(l.anisotropy, std::cos(l.anisotropy_rotation), std::sin(l.anisotropy_rotation)));
  for (std::size_t i = 0; i < kLobeMaps; ++i) {
    if (!((needs | forced_) & lobe_map_need(i))) continue;
    const int unit = kFirstLobeUnit + static_cast<int>(i);
    if (needs & lobe_map_need(i)) {
      bind_texture(unit, l.maps[i], images, GL_LINEAR_MIPMAP_LINEAR);
    } else {
      glActiveTexture(GL_TEXTURE0 + static_cast<GLenum>(unit));
      glBindTexture(GL_TEXTURE_2D, neutral_map(static_cast<LobeMap>(i)).id());
    }
    p.set(lobe_map_sampler(i), unit);
    put_uv_transform(l.maps[i], &transforms[2 * (5 + i)]);
  }
}

void MeshPass::draw(const GpuMesh& mesh, const std::vector<Material>& materials,
                    const GpuImages& images, const MeshInstance* instances, std::size_t count,
                    bool blended) {
  bool bound = false;
  const bool fading = std::any_of(instances, instances + count,
                                  [](const MeshInstance& one) { return one.fade < 1; });
  for (const Primitive& primitive : mesh.primitives()) {
    const Material& material = materials[primitive.material];
    if ((material.alpha_mode == AlphaMode::kBlend) != blended || primitive.index_count == 0) {
      continue;
    }
    if (!bound) {
      glBindVertexArray(mesh.vertex_array());
      bind_instances(instances, count);
      bound = true;
    }
    const NeedMask needs = material_needs(material, mesh.vertex_color());
    (material.double_sided ? glDisable : glEnable)(GL_CULL_FACE);
    const bool blends = blended || (forced_ & kNeedBlend);
    const bool replaces = output_ == MeshOutput::kFront || output_ == MeshOutput::kTint;
    (blends && !replaces ? glEnable : glDisable)(GL_BLEND);
    for (const Stage stage : stages(needs)) {
      const Result<Program*> made = program(needs, fading, stage);
      if (!made) continue;  // warm_up has reported it
      use(**made, material, needs, images, stage);
      draw_elements(gl_mode(primitive.kind), primitive.first_index, primitive.index_count, count);
      ++draw_calls_;
    }
  }
}

std::vector<MeshPass::Stage> MeshPass::stages(NeedMask needs) const {
  const bool depth_only = output_ == MeshOutput::kDepth || output_ == MeshOutput::kClear;
  if (depth_only || of_blended()) return {Stage::kDepth};
  if (needs & kNeedAlphaMask) return {Stage::kDepth, Stage::kTested};
  return {Stage::kWhole};
}

void MeshPass::use(Program& p, const Material& material, NeedMask needs, const GpuImages& images,
                   Stage stage) {
  p.use();
  p.set("u_clip_from_relative", clip_from_relative_);
  p.set("u_ambient", lights_.ambient);
  p.set("u_neutral", neutral_ ? 1 : 0);
  p.set("u_light_count", lights_.count);
  p.set("u_lights", lights_.lights);
  if (shadow_) {
    p.set("u_sun", lights_.sun);
    shadow_->use(p, eye_);
  }
  if (probe_ || forced_) (probe_ ? *probe_ : black_probe_).use(p, lights_.probe);
  if (output_ == MeshOutput::kBehind || output_ == MeshOutput::kClear) {
    p.set("u_floor", kFloorUnit);
    p.set("u_floor_samples", floor_samples_);
    p.set("u_clear_of", clear_of_);
    glActiveTexture(GL_TEXTURE0 + kFloorUnit);
    glBindTexture(GL_TEXTURE_2D, floor_);
  }
  p.set("u_tint", tint_);
  p.set("u_mip_bias", stage == Stage::kDepth ? tested_mip_bias_ : mip_bias_);
  p.set("u_point_size", stroke_);
  if (of_blended()) p.set("u_least_alpha", least_alpha_);
  p.set("u_fog_color", fog_color_);
  p.set("u_fog_density", fog_density_);
  bind_material(p, material, needs, images, stage);
  const bool depth = stage == Stage::kDepth, tested = stage == Stage::kTested;
  // An alpha test discards whole pixels, so a multisampled target runs it for every sample.
  if (*samples_) shade_samples(depth);
  const GLboolean colors = depth && !of_blended() ? GL_FALSE : GL_TRUE;
  glColorMask(colors, colors, colors, colors);
  glDepthFunc(tested ? GL_EQUAL : nearer_);
  const bool hides = !(needs & kNeedBlend) || output_ == MeshOutput::kFront;
  glDepthMask(tested || !hides ? GL_FALSE : GL_TRUE);
}

void MeshPass::end() {
  glBindVertexArray(0);
  glDisable(GL_CULL_FACE);
  glDisable(GL_BLEND);
  glBlendEquation(GL_FUNC_ADD);
  if (*samples_) shade_samples(false);
  glColorMask(GL_TRUE, GL_TRUE, GL_TRUE, GL_TRUE);
  glDepthFunc(nearer_);
  glLineWidth(1.0f);
  glDepthMask(GL_TRUE);
}

}  // namespace mirage::gl
