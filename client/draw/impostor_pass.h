#pragma once
// Impostor pass: draws impostors from the atlas, back to front. It makes one instanced call for
// each run with the same method; convex hulls and warps also need the same object. GLES 3.0 subset.

#include <map>
#include <set>
#include <vector>

#include "client/draw/impostor_atlas.h"
#include "client/draw/proxy_triangles.h"
#include "client/frame/draw_list.h"
#include "client/scene/scene_view.h"
#include "protocol/base/result.h"
#include "shaders/gl/gl_object.h"
#include "shaders/gl/mesh_pass.h"
#include "shaders/gl/probe_map.h"
#include "shaders/gl/program.h"

namespace mirage {

struct Drawing;
struct Tints;

class ImpostorPass {
 public:
  /// Creates the pass. `flat` are the flat methods that will be drawn; only their programs are
  /// made. Errors kGraphicsShader, kGraphicsGl (atlas too large).
  static Result<ImpostorPass> create(int atlas_edge, int atlas_layers, std::set<DrawMethod> flat);

  /// Learns a new scene: its proxies, and programs with or without its fog, shadows and probe.
  /// Error kGraphicsShader: the former programs stay.
  Result<void> reset(const SceneView& scene);
  /// Uploads a tile. The first layered tile makes its program. Errors kGraphicsGl, kGraphicsShader.
  Result<void> upload(const TileRecord& record, const AtlasPlanes& planes);
  /// Draws the impostors and placeholders of the list. `shadow_atlas` is the texture of
  /// ShadowAtlas; 0: impostors show no shadow. `probe` is the scene's; nullptr: none.
  void draw(const Drawing& d, GLuint shadow_atlas, const gl::ProbeMap* probe);

  /// Draws the same into the bound framebuffer, each thing in its tint. Error kGraphicsShader: the
  /// programs for it cannot be made.
  Result<void> draw_tints(const Drawing& d, const Tints& tints);

  /// Chooses whether the soft edges of entangled things are drawn after everything solid. That is
  /// right, and draws these things twice.
  void draw_edges_last(bool on) {
    edges_last_ = on;
    entangled_.clear();
  }

  int draw_calls() const { return draw_calls_; }
  void reset_draw_calls() { draw_calls_ = 0; }
  std::size_t gpu_bytes() const { return atlas_.gpu_bytes(); }

 private:
  struct Proxy {
    gl::VertexArray vao;
    gl::Buffer vertices;
    int vertex_count = 0;
  };
  /// Features of a scene that not every scene has: defines of its programs.
  struct Variant {
    bool fog = false, shadows = false, probe = false;
  };
  /// Programs by method, and for relit tiles or not.
  struct Programs {
    std::map<std::pair<DrawMethod, bool>, gl::Program> flat;
    gl::Program relief, relit_relief, placeholder;
    gl::Program layered_relief;  ///< for layered tiles; made with the first of them
  };
  static Result<gl::Program> make_program(const char* name, std::vector<std::string> defines,
                                          const Variant& v);
  Result<Programs> make_programs(const Variant& v) const;
  Result<Programs> make_tint_programs() const;
  static Proxy make_proxy(const std::vector<ProxyVertex>& triangles);
  template <typename InstanceT>
  void draw_instances(const Proxy& proxy, const std::vector<InstanceT>& instances, bool cull);
  /// Fragments of an impostor that are drawn at once. With kAll all fragments are drawn and write
  /// depth. A farther thing that is drawn later is then missing behind a soft edge. Groups and
  /// blended objects drawn flat are soft within, and parts of one object meet at soft edges. Their
  /// solid fragments are drawn first; the soft ones write no depth. With draw_edges_last() this is
  /// so for entangled things, too.
  enum class Fragments { kAll, kSolid, kSoft };
  using DrawnImpostors = std::vector<const DrawnImpostor*>;
  Fragments fragments_of(const DrawnImpostor& drawn, const SceneView& scene, bool solid) const;
  /// Draws the list in its order: with `solid` the solid fragments that come first, otherwise all
  /// others.
  void draw_runs(const Drawing& d, bool solid);
  /// Draws placeholders and runs, as draw() and draw_tints() do.
  void draw_list(const Drawing& d);
  Programs& programs() { return tints_ ? tint_programs_ : programs_; }
  /// Returns the tint of an impostor of the list.
  glm::vec4 tint_of(const DrawnImpostor& drawn, const DrawList& list) const;
  /// Draws a run of impostors that are drawn alike; it is not empty.
  void draw_flat(const Drawing& d, const DrawnImpostors& run, Fragments fragments);
  void draw_relief(const Drawing& d, const DrawnImpostors& run, Fragments fragments);
  void use_atlas(gl::Program& program, const Drawing& d, bool relit);
  /// Draws the placeholders of solid objects, or of those through which one sees.
  void draw_placeholders(const Drawing& d, bool solid);

  const Proxy& hull(const SceneView& scene, std::uint32_t object);
  const Proxy& warp_proxy(const SceneView& scene, std::uint32_t object);

  ImpostorAtlas atlas_;
  std::set<DrawMethod> flat_;  ///< methods with programs
  Programs programs_;
  Programs tint_programs_;  ///< made by the first draw_tints(); relit tiles need none of their own
  const Tints* tints_ = nullptr;  ///< what is drawn now; null: the picture
  gl::Buffer instances_;
  Proxy quad_;
  Proxy cube_;
  std::map<std::uint32_t, Proxy> hulls_, warp_proxies_;  ///< by object, made when first drawn
  gl::LightBlock lights_;                                ///< lights of the frame
  glm::vec3 placeholder_light_{1};                       ///< that lit placeholders are seen in
  Variant variant_;                                      ///< variant of the programs
  GLuint shadow_atlas_ = 0;
  const gl::ProbeMap* probe_ = nullptr;
  glm::vec3 shadow_tint_{1};
  glm::vec3 fog_color_{0};
  float fog_density_ = 0;
  bool neutral_ = false;  ///< ToneCurve::kNeutral
  int draw_calls_ = 0;
  bool edges_last_ = false;
  std::vector<std::uint32_t> entangled_;  ///< instances of the frame with their edges drawn last
};

}  // namespace mirage
