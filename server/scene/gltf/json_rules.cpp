#include "server/scene/gltf/json_rules.h"

namespace mirage::gltf {
namespace {

constexpr bool kRequired = true;
constexpr bool kOptional = false;

Rule index(std::string_view key, std::string_view target, bool required = kOptional) {
  return {key, Kind::kIndex, required, target};
}
Rule count(std::string_view key, bool required = kOptional) {
  return {key, Kind::kCount, required};
}
Rule number(std::string_view key) { return {key, Kind::kNumber}; }
Rule numbers(std::string_view key, std::size_t size) {
  return {key, Kind::kNumbers, kOptional, {}, nullptr, size};
}
Rule vital(Rule rule) {
  rule.flaw = Flaw::kObject;
  return rule;
}
/// A list whose elements others refer to by index.
Rule indexed(Rule rule, std::string_view stand_in) {
  rule.stand_in = stand_in;
  return rule;
}
Rule object(std::string_view key, const Schema& schema, bool required = kOptional) {
  return {key, Kind::kObject, required, {}, &schema};
}
Rule objects(std::string_view key, const Schema& schema, bool required = kOptional) {
  return {key, Kind::kObjectList, required, {}, &schema};
}
Rule name() { return {"name", Kind::kName}; }

const Schema& empty_schema() {
  static const Schema kSchema;
  return kSchema;
}

const Schema& accessor_schema() {
  static const Schema kIndices{{index("bufferView", "bufferViews", kRequired),
                                vital(count("byteOffset")), count("componentType", kRequired)}};
  static const Schema kValues{
      {index("bufferView", "bufferViews", kRequired), vital(count("byteOffset"))}};
  static const Schema kSparse{{count("count", kRequired), object("indices", kIndices, kRequired),
                               object("values", kValues, kRequired)}};
  static const Schema kSchema{
      {vital(index("bufferView", "bufferViews")),
       vital(count("byteOffset")),
       {"componentType", Kind::kComponent, kRequired},
       {"normalized", Kind::kFlag},
       count("count", kRequired),
       {"type", Kind::kChoice, kRequired, "SCALAR VEC2 VEC3 VEC4 MAT2 MAT3 MAT4"},
       vital(object("sparse", kSparse))}};
  return kSchema;
}

const Schema& texture_info_schema() {
  static const Schema kTransform{
      {numbers("offset", 2), number("rotation"), numbers("scale", 2), count("texCoord")}};
  static const Schema kExtensions{{object("KHR_texture_transform", kTransform)}};
  static const Schema kSchema{{index("index", "textures", kRequired), count("texCoord"),
                               number("scale"), number("strength"),
                               object("extensions", kExtensions)}};
  return kSchema;
}

const Schema& material_extension_schema() {
  const Schema& info = texture_info_schema();
  static const Schema kStrength{{number("emissiveStrength")}};
  static const Schema kSpecGloss{{numbers("diffuseFactor", 4), object("diffuseTexture", info),
                                  numbers("specularFactor", 3), number("glossinessFactor"),
                                  object("specularGlossinessTexture", info)}};
  static const Schema kSpecular{{number("specularFactor"), object("specularTexture", info),
                                 numbers("specularColorFactor", 3),
                                 object("specularColorTexture", info)}};
  static const Schema kIor{{number("ior")}};
  static const Schema kClearcoat{{number("clearcoatFactor"), object("clearcoatTexture", info),
                                  number("clearcoatRoughnessFactor"),
                                  object("clearcoatRoughnessTexture", info),
                                  object("clearcoatNormalTexture", info)}};
  static const Schema kSheen{{numbers("sheenColorFactor", 3), object("sheenColorTexture", info),
                              number("sheenRoughnessFactor"),
                              object("sheenRoughnessTexture", info)}};
  static const Schema kTransmission{
      {number("transmissionFactor"), object("transmissionTexture", info)}};
  static const Schema kVolume{{number("thicknessFactor"), object("thicknessTexture", info),
                               number("attenuationDistance"), numbers("attenuationColor", 3)}};
  static const Schema kAnisotropy{{number("anisotropyStrength"), number("anisotropyRotation"),
                                   object("anisotropyTexture", info)}};
  static const Schema kSchema{
      {object("KHR_materials_unlit", empty_schema()),
       object("KHR_materials_emissive_strength", kStrength),
       object("KHR_materials_pbrSpecularGlossiness", kSpecGloss),
       object("KHR_materials_specular", kSpecular), object("KHR_materials_ior", kIor),
       object("KHR_materials_clearcoat", kClearcoat), object("KHR_materials_sheen", kSheen),
       object("KHR_materials_transmission", kTransmission), object("KHR_materials_volume", kVolume),
       object("KHR_materials_anisotropy", kAnisotropy)}};
  return kSchema;
}

const Schema& material_schema() {
  const Schema& info = texture_info_schema();
  static const Schema kPbr{{numbers("baseColorFactor", 4), object("baseColorTexture", info),
                            number("metallicFactor"), number("roughnessFactor"),
                            object("metallicRoughnessTexture", info)}};
  static const Schema kSchema{{name(),
                               object("pbrMetallicRoughness", kPbr),
                               object("normalTexture", info),
                               object("occlusionTexture", info),
                               object("emissiveTexture", info),
                               numbers("emissiveFactor", 3),
                               {"alphaMode", Kind::kText},
                               number("alphaCutoff"),
                               {"doubleSided", Kind::kFlag},
                               object("extensions", material_extension_schema())}};
  return kSchema;
}

const Schema& texture_schema() {
  static const Schema kWebp{{index("source", "images")}};
  static const Schema kExtensions{
      {object("EXT_texture_webp", kWebp), object("KHR_texture_basisu", kWebp)}};
  static const Schema kSchema{
      {index("sampler", "samplers"), index("source", "images"), object("extensions", kExtensions)}};
  return kSchema;
}

const Schema& view_schema() {
  static const Schema kMeshopt{{index("buffer", "buffers", kRequired),
                                count("byteOffset"),
                                count("byteLength", kRequired),
                                count("byteStride", kRequired),
                                count("count", kRequired),
                                {"mode", Kind::kText, kRequired},
                                {"filter", Kind::kText}}};
  static const Schema kExtensions{{vital(object("EXT_meshopt_compression", kMeshopt)),
                                   vital(object("KHR_meshopt_compression", kMeshopt))}};
  static const Schema kSchema{{index("buffer", "buffers", kRequired), vital(count("byteOffset")),
                               count("byteLength", kRequired), vital(count("byteStride")),
                               vital(object("extensions", kExtensions))}};
  return kSchema;
}

const Schema& buffer_schema() {
  static const Schema kFallback{{{"fallback", Kind::kFlag}}};
  static const Schema kExtensions{
      {object("EXT_meshopt_compression", kFallback), object("KHR_meshopt_compression", kFallback)}};
  static const Schema kSchema{
      {{"uri", Kind::kText}, count("byteLength"), object("extensions", kExtensions)}};
  return kSchema;
}

const Schema& mesh_schema() {
  static const Schema kDraco{
      {index("bufferView", "bufferViews", kRequired), {"attributes", Kind::kCountMap, kRequired}}};
  static const Schema kMapping{{index("material", "materials", kRequired),
                                {"variants", Kind::kIndexList, kRequired, "variants"}}};
  static const Schema kVariants{{objects("mappings", kMapping, kRequired)}};
  static const Schema kExtensions{
      {object("KHR_draco_mesh_compression", kDraco), object("KHR_materials_variants", kVariants)}};
  static const Schema kPrimitive{{{"attributes", Kind::kIndexMap, kRequired, "accessors"},
                                  vital(index("indices", "accessors")),
                                  index("material", "materials"),
                                  vital(count("mode")),
                                  {"targets", Kind::kIndexMapList, kOptional, "accessors"},
                                  object("extensions", kExtensions)}};
  static const Schema kSchema{{name(), objects("primitives", kPrimitive), numbers("weights", 0)}};
  return kSchema;
}

const Schema& node_schema() {
  static const Schema kLight{{index("light", "lights", kRequired)}};
  static const Schema kInstancing{{{"attributes", Kind::kIndexMap, kRequired, "accessors"}}};
  static const Schema kVisibility{{{"visible", Kind::kFlag}}};
  static const Schema kExtensions{{object("KHR_lights_punctual", kLight),
                                   object("EXT_mesh_gpu_instancing", kInstancing),
                                   object("KHR_node_visibility", kVisibility)}};
  static const Schema kSchema{{name(),
                               index("camera", "cameras"),
                               {"children", Kind::kIndexList, kOptional, "nodes"},
                               index("skin", "skins"),
                               numbers("matrix", 16),
                               index("mesh", "meshes"),
                               numbers("rotation", 4),
                               numbers("scale", 3),
                               numbers("translation", 3),
                               numbers("weights", 0),
                               object("extensions", kExtensions)}};
  return kSchema;
}

const Schema& camera_schema() {
  static const Schema kPerspective{
      {number("aspectRatio"), number("yfov"), number("zfar"), number("znear")}};
  static const Schema kOrthographic{
      {number("xmag"), number("ymag"), number("zfar"), number("znear")}};
  static const Schema kSchema{{{"type", Kind::kChoice, kRequired, "perspective orthographic"},
                               object("perspective", kPerspective),
                               object("orthographic", kOrthographic)}};
  return kSchema;
}

const Schema& lights_schema() {
  static const Schema kSpot{{number("innerConeAngle"), number("outerConeAngle")}};
  static const Schema kLight{{{"type", Kind::kText, kRequired},
                              numbers("color", 3),
                              number("intensity"),
                              number("range"),
                              object("spot", kSpot)}};
  static const Schema kSchema{{indexed(objects("lights", kLight, kRequired), R"({"type":""})")}};
  return kSchema;
}

constexpr std::string_view kNoAccessor = R"({"componentType":5120,"count":0,"type":"SCALAR"})";
constexpr std::string_view kNoView = R"({"buffer":0,"byteLength":0})";
constexpr std::string_view kNoCamera =
    R"({"type":"perspective","perspective":{"yfov":0.8,"znear":0.1}})";

}  // namespace

const Schema& root_schema() {
  static const Schema kAsset{{{"version", Kind::kText, kRequired}, {"minVersion", Kind::kText}}};
  static const Schema kImage{
      {{"uri", Kind::kText}, {"mimeType", Kind::kText}, index("bufferView", "bufferViews")}};
  static const Schema kSampler{
      {count("magFilter"), count("minFilter"), count("wrapS"), count("wrapT")}};
  static const Schema kScene{{name(), vital({"nodes", Kind::kIndexList, kOptional, "nodes"})}};
  static const Schema kSkin{{name(),
                             vital(index("inverseBindMatrices", "accessors")),
                             index("skeleton", "nodes"),
                             {"joints", Kind::kIndexList, kRequired, "nodes"}}};
  static const Schema kVariant{{name()}};
  static const Schema kVariants{{indexed(objects("variants", kVariant, kRequired), "{}")}};
  static const Schema kCenter{{numbers("center", 3)}};
  static const Schema kExtensions{{object("KHR_lights_punctual", lights_schema()),
                                   object("KHR_materials_variants", kVariants),
                                   object("CESIUM_RTC", kCenter)}};
  static const Schema kSchema{{object("asset", kAsset, kRequired),
                               {"extensionsUsed", Kind::kTexts},
                               {"extensionsRequired", Kind::kTexts},
                               indexed(objects("accessors", accessor_schema()), kNoAccessor),
                               indexed(objects("bufferViews", view_schema()), kNoView),
                               indexed(objects("buffers", buffer_schema()), "{}"),
                               indexed(objects("cameras", camera_schema()), kNoCamera),
                               indexed(objects("images", kImage), "{}"),
                               indexed(objects("materials", material_schema()), "{}"),
                               indexed(objects("meshes", mesh_schema()), "{}"),
                               indexed(objects("nodes", node_schema()), "{}"),
                               indexed(objects("samplers", kSampler), "{}"),
                               index("scene", "scenes"),
                               indexed(objects("scenes", kScene), kWholeList),
                               indexed(objects("skins", kSkin), R"({"joints":[]})"),
                               indexed(objects("textures", texture_schema()), "{}"),
                               object("extensions", kExtensions)}};
  return kSchema;
}

}  // namespace mirage::gltf
