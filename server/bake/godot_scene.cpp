// Scenes for the impostor add-ons of Godot 3 and 4: a quad whose material has the bake's pictures,
// and a second one that only casts shadows. Pictures are named relative to the scene.

#include "server/bake/engine_texts.h"

namespace mirage {
namespace {

// How one version of Godot writes a scene.
struct Dialect {
  int format;
  const char* node;
  const char* mesh_node;
  const char* texture;
  const char* parameter;  // before the name of a shader's parameter
  const char* shader;
  const char* shadow_shader;
};
constexpr Dialect kGodot3{
    2,
    "Spatial",
    "MeshInstance",
    "Texture",
    "shader_param/",
    "res://addons/octahedral_impostors/materials/shaders/ImpostorShader.shader",
    "res://addons/octahedral_impostors/materials/shaders/ImpostorShaderShadows.shader"};
constexpr Dialect kGodot4{
    3,
    "Node3D",
    "MeshInstance3D",
    "Texture2D",
    "shader_parameter/",
    "res://addons/Imposter/imposter/materials/shaders/ImpostorShader.gdshader",
    "res://addons/Imposter/imposter/materials/shaders/ImpostorShaderShadows.gdshader"};

struct Picture {
  const char* map;
  const char* parameter;
};
constexpr Picture kPictures[] = {{"color", "imposterTextureAlbedo"},
                                 {"normal", "imposterTextureNormal"},
                                 {"depth", "imposterTextureDepth"},
                                 {"orm", "imposterTextureOrm"}};

class SceneWriter {
 public:
  SceneWriter(const EngineTextInput& in, const Dialect& dialect) : in_(in), dialect_(dialect) {}

  std::string text() {
    std::string resources =
        resource("Shader", dialect_.shader, 1) + resource("Shader", dialect_.shadow_shader, 2);
    int id = 3;
    std::string pictures;
    for (const auto& picture : kPictures) {
      const std::string file = in_.file(picture.map);
      if (file.empty()) continue;
      resources += resource(dialect_.texture, file, id);
      pictures += line(picture.parameter, reference("ExtResource", id++));
    }
    const double r = in_.radius();
    const int steps = id + 4;  // as the editor counts: all resources and the scene itself
    return "[gd_scene load_steps=" + std::to_string(steps) +
           " format=" + std::to_string(dialect_.format) + "]\n\n" + resources + "\n" +
           material(1, 1, r / 2, look() + pictures) + quad(3, 1) +
           material(2, 2, -r / 2, pictures) + quad(4, 2) + "[node name=\"Impostor\" type=\"" +
           dialect_.node + "\"]\n\n" + mesh("mesh-impostor", 3, "") +
           mesh("shadow-impostor", 4, "cast_shadow = 3\n");
  }

 private:
  bool old() const { return dialect_.format == 2; }

  std::string resource(const std::string& type, const std::string& path, int id) const {
    return "[ext_resource path=\"" + path + "\" type=\"" + type + "\" id=" + quoted(id) + "]\n";
  }
  std::string quoted(int id) const {
    return old() ? std::to_string(id) : "\"" + std::to_string(id) + "\"";
  }
  std::string reference(const char* kind, int id) const {
    return std::string(kind) + (old() ? "( " + quoted(id) + " )" : "(" + quoted(id) + ")");
  }
  std::string line(const char* name, const std::string& value) const {
    return dialect_.parameter + std::string(name) + " = " + value + "\n";
  }

  // Factors of 1 leave the pictures as they are; depth is off by default.
  std::string look() const {
    return line("specular", "0.5") + line("metallic", "1.0") + line("roughness", "1.0") +
           line("depth_scale", "1.0") + line("normalmap_depth", "1.0") + line("dither", "false");
  }

  // `push`: how far the quad moves toward the camera.
  std::string material(int id, int shader, double push, const std::string& more) const {
    const std::string n = std::to_string(in_.master.grid);
    const bool whole = in_.master.layout == BakeLayout::kOctahedral;
    return "[sub_resource type=\"ShaderMaterial\" id=" + quoted(id) +
           "]\nshader = " + reference("ExtResource", shader) + "\n" +
           line("imposterFrames", "Vector2(" + n + ", " + n + ")") +
           line("positionOffset", "Vector3(0, 0, 0)") +
           line("isFullSphere", whole ? "true" : "false") + line("alpha_clamp", "0.5") +
           line("scale", number(in_.radius())) + line("aabb_max", number(push)) + more + "\n";
  }

  std::string quad(int id, int material) const {
    return "[sub_resource type=\"QuadMesh\" id=" + quoted(id) +
           "]\nmaterial = " + reference("SubResource", material) + "\n\n";
  }

  // The node stands at the centre, because the shader takes directions from the node's origin. Its
  // quad is drawn up to 2 radii around, which the engine cannot know.
  std::string mesh(const char* name, int quad, const std::string& more) const {
    const glm::dvec3 c = in_.center();
    const char* type = old() ? "Transform" : "Transform3D";
    return std::string("[node name=\"") + name + "\" type=\"" + dialect_.mesh_node +
           "\" parent=\".\"]\ntransform = " + type + "(1, 0, 0, 0, 1, 0, 0, 0, 1, " + number(c.x) +
           ", " + number(c.y) + ", " + number(c.z) +
           ")\nextra_cull_margin = " + number(2 * in_.radius()) + "\n" + more +
           "mesh = " + reference("SubResource", quad) + "\n\n";
  }

  const EngineTextInput& in_;
  const Dialect& dialect_;
};

}  // namespace

BakeText godot3_scene(const EngineTextInput& in) {
  return {in.name + "/impostor.tscn", SceneWriter(in, kGodot3).text()};
}

BakeText godot4_scene(const EngineTextInput& in) {
  return {in.name + "_imposter.tscn", SceneWriter(in, kGodot4).text()};
}

}  // namespace mirage
