// Texts for Unity, Unreal and three.js: the values that each consumer's material needs.

#include <nlohmann/json.hpp>

#include "server/bake/engine_texts.h"

namespace mirage {
namespace {

using Json = nlohmann::ordered_json;

Json array(const glm::dvec3& v) { return {v.x, v.y, v.z}; }

std::string flag(bool value, const char* yes, const char* no) { return value ? yes : no; }

std::string python_texture(const EngineTextInput& in, const char* map, const char* parameter,
                           bool srgb) {
  const std::string file = in.file(map);
  if (file.empty()) return {};
  return "    (\"" + file + "\", \"" + parameter + "\", " + flag(srgb, "True", "False") + "),\n";
}

constexpr const char* kUnrealBody = R"(

def imported(name, srgb):
    task = unreal.AssetImportTask()
    task.filename = os.path.join(os.path.dirname(os.path.abspath(__file__)), name)
    task.destination_path = FOLDER
    task.automated = True
    task.replace_existing = True
    task.save = False
    unreal.AssetToolsHelpers.get_asset_tools().import_asset_tasks([task])
    texture = unreal.load_asset(FOLDER + "/" + os.path.splitext(name)[0])
    # The normal map has depth in its alpha, which TC_Normalmap would drop.
    texture.set_editor_property("compression_settings",
                                unreal.TextureCompressionSettings.TC_DEFAULT)
    texture.set_editor_property("srgb", srgb)
    unreal.EditorAssetLibrary.save_loaded_asset(texture)
    return texture


def instance():
    tools = unreal.AssetToolsHelpers.get_asset_tools()
    path = FOLDER + "/MI_" + NAME
    if unreal.EditorAssetLibrary.does_asset_exist(path):
        return unreal.load_asset(path)
    return tools.create_asset("MI_" + NAME, FOLDER, unreal.MaterialInstanceConstant,
                              unreal.MaterialInstanceConstantFactoryNew())


def main():
    edit = unreal.MaterialEditingLibrary
    made = instance()
    edit.set_material_instance_parent(made, unreal.load_asset(MATERIAL))
    for name, parameter, srgb in TEXTURES:
        edit.set_material_instance_texture_parameter_value(made, parameter, imported(name, srgb))
    for parameter, value in SCALARS:
        edit.set_material_instance_scalar_parameter_value(made, parameter, value)
    edit.set_material_instance_vector_parameter_value(made, "Pivot Offset",
                                                      unreal.LinearColor(*PIVOT_OFFSET))
    edit.set_material_instance_static_switch_parameter_value(made, "Full Sphere", FULL_SPHERE)
    edit.update_material_instance(made)
    unreal.EditorAssetLibrary.save_loaded_asset(made)


main()
)";

constexpr const char* kThreeBody = R"(
// Returns the impostor. `THREE`: the module three; `OctahedralImpostor`: the class of the package;
// `renderer`: a WebGLRenderer, which bakes a placeholder of a few texels that is then replaced.
export async function loadImpostor(THREE, OctahedralImpostor, renderer) {
  const white = new THREE.DataTexture(new Uint8Array([255, 255, 255, 255]), 1, 1);
  white.needsUpdate = true;
  const placeholder = new THREE.Mesh(new THREE.SphereGeometry(RADIUS, 16, 8),
    new THREE.MeshStandardMaterial({ map: white, normalMap: white }));
  placeholder.geometry.translate(...CENTER);
  const target = new THREE.Group().add(placeholder);
  const impostor = new OctahedralImpostor({
    renderer, target, useHemiOctahedron: true, transparent: false, alphaClamp: 0.5,
    spritesPerSide: FRAMES, textureSize: 4 * FRAMES, baseType: THREE.MeshStandardMaterial });
  const loader = new THREE.TextureLoader();
  const load = file => loader.loadAsync(new URL(file, import.meta.url).href);
  const { material } = impostor;
  material.ezImpostorUniforms.impostorTransform.value
    .makeScale(2 * RADIUS, 2 * RADIUS, 2 * RADIUS).setPosition(...CENTER);
  impostor.frustumCulled = false;  // its geometry does not tell where it is drawn
)";

}  // namespace

BakeText unity_material(const EngineTextInput& in) {
  Json properties{{"_ImposterFrames", in.master.grid},
                  {"_ImposterSize", in.radius()},
                  {"_ImposterOffset", array(in.center())},
                  {"_ImposterFullSphere", in.master.layout == BakeLayout::kOctahedral ? 1 : 0},
                  {"_ImposterBorderClamp", 2},
                  {"_Cutoff", .3}};
  Json textures = Json::object();
  const auto add = [&](const char* property, const char* map, bool srgb) {
    const std::string file = in.file(map);
    if (file.empty()) return;
    textures[property] = Json{{"file", file},
                              {"sRGBTexture", srgb},
                              {"alphaSource", "FromInput"},
                              {"alphaIsTransparency", false},
                              {"wrapMode", "Clamp"},
                              {"mipmapEnabled", true},
                              {"maxTextureSize", in.master.grid * in.master.tile}};
  };
  add("_ImposterBaseTex", "color", true);
  add("_ImposterWorldNormalDepthTex", "normal", false);
  const Json all{{"shader", "XRA/IMP/Standard (Surface)"},
                 {"properties", properties},
                 {"textures", textures},
                 {"mesh", "quad of 5 vertices: the corners and the middle"},
                 {"checked", "layout checked against the source at commit a9391b4"}};
  return {in.name + "_Imposter.unity.json", all.dump(2) + "\n"};
}

BakeText unreal_script(const EngineTextInput& in) {
  const glm::dvec3 c = in.center();
  std::string text =
      "# Imports a bake into the project and makes its material instance. Run it in the editor:\n"
      "# Tools, Execute Python Script. It has not been tried in an editor.\n"
      "import os\n\nimport unreal\n\nNAME = \"" +
      in.name + "\"\nFOLDER = \"/Game/Impostors/" + in.name + "\"\n# The material of your baker." +
      "\nMATERIAL = \"/ImpostorBaker/ImpostorBaker/Materials/" +
      flag(in.master.layout == BakeLayout::kOctahedral, "M_Impostor_SimpleOffset_FullSphere",
           "M_Impostor_SimpleOffset") +
      "\"\n# File, texture parameter of the material, sRGB.\nTEXTURES = [\n" +
      python_texture(in, "color", "BaseColor", true) +
      python_texture(in, "normal", "Normal", false) +
      python_texture(in, "orm", "MetallicRoughnessSpecularAO", false) +
      "]\n# Lengths in cm.\nSCALARS = [(\"FramesXY\", " + number(in.master.grid) +
      "), (\"Default Mesh Size\", " + number(2 * in.radius()) + ")]\nPIVOT_OFFSET = (" +
      number(c.x) + ", " + number(c.y) + ", " + number(c.z) + ", 0.0)\nFULL_SPHERE = " +
      flag(in.master.layout == BakeLayout::kOctahedral, "True", "False") + "\n" + kUnrealBody;
  return {"import_" + in.name + ".py", text};
}

BakeText three_loader(const EngineTextInput& in) {
  const glm::dvec3 c = in.center();
  std::string text =
      "// Loads a bake into an OctahedralImpostor of octahedral-impostor.\n"
      "const FRAMES = " +
      std::to_string(in.master.grid) + ";\nconst RADIUS = " + number(in.radius()) +
      ";\nconst CENTER = [" + number(c.x) + ", " + number(c.y) + ", " + number(c.z) + "];\n" +
      kThreeBody;
  if (const std::string file = in.file("color"); !file.empty()) {
    text += "  material.map = await load('" + file +
            "');\n  material.map.colorSpace = THREE.SRGBColorSpace;\n";
  }
  if (const std::string file = in.file("normal"); !file.empty()) {
    text += "  material.normalMap = await load('" + file +
            "');\n  material.normalMap.magFilter = THREE.NearestFilter;\n"
            "  material.normalMap.minFilter = THREE.NearestFilter;\n"
            "  material.normalMap.generateMipmaps = false;\n";
  }
  text += "  material.needsUpdate = true;\n  return impostor;\n}\n";
  return {in.name + ".three.js", text};
}

}  // namespace mirage
