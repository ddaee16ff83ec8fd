#include "server/scene/builtin/builtin_scene.h"

#include <algorithm>
#include <array>

#include "server/scene/builtin/scene_parts.h"

namespace mirage {
namespace {

using builtin::OptionRule;

constexpr double kMaxSeed = 4294967295.0;

constexpr OptionRule kFogRule{"fog", 0, 0, 1, false};  // per metre

constexpr std::array<OptionRule, 5> kForestRules = {{{"trees", 400, 1, 20000},
                                                     {"species", 4, 1, 8},
                                                     {"seed", 1, 0, kMaxSeed},
                                                     {"clutter", 150, 0, 20000},
                                                     kFogRule}};
constexpr std::array<OptionRule, 2> kClutterRules = {
    {{"objects", 300, 1, 20000}, {"seed", 1, 0, kMaxSeed}}};
constexpr std::array<OptionRule, 3> kCityRules = {
    {{"blocks", 6, 1, 60}, {"seed", 1, 0, kMaxSeed}, kFogRule}};
constexpr std::array<OptionRule, 3> kMuseumRules = {
    {{"objects", 60, 1, 200}, {"seed", 1, 0, kMaxSeed}, {"triangles", 650000, 2000, 2000000}}};
constexpr std::array<OptionRule, 6> kKnotRules = {{{"R", 1, 0.01, 1000, false},
                                                   {"r", 0.35, 0.001, 1000, false},
                                                   {"tubular", 200, 3, 4096},
                                                   {"radial", 32, 3, 1024},
                                                   {"p", 2, 1, 20},
                                                   {"q", 3, 1, 20}}};
constexpr std::array<OptionRule, 2> kFieldRules = {
    {{"instances", 10000, 1, 1000000}, {"seed", 1, 0, kMaxSeed}}};

struct Builder {
  const char* name;
  const char* description;
  std::span<const OptionRule> rules;
  Scene (*build)(const builtin::OptionValues&, const LoadTools&);
};

/// Adapts a builder that needs no load tools, because its scene is cheap to build.
template <Scene (*build)(const builtin::OptionValues&)>
Scene alone(const builtin::OptionValues& values, const LoadTools&) {
  return build(values);
}

constexpr std::array<Builder, 6> kBuilders = {{
    {"forest", "a walk through a wood of detailed trees, with hills, a pond and sky", kForestRules,
     alone<builtin::build_forest>},
    {"clutter", "a furnished room full of small objects", kClutterRules,
     alone<builtin::build_clutter>},
    {"city", "blocks of buildings with streets, cars and a plaza", kCityRules,
     alone<builtin::build_city>},
    {"museum", "a round hall of heavy sculptures, each with a mesh and textures of its own",
     kMuseumRules, builtin::build_museum},
    {"knot", "one torus knot", kKnotRules, alone<builtin::build_knot>},
    {"field", "a meadow with very many light instances", kFieldRules, alone<builtin::build_field>},
}};

Error unknown_scene(const std::string& name) {
  std::vector<std::string> names;
  std::string all;
  for (const Builder& builder : kBuilders) {
    names.emplace_back(builder.name);
    all += (all.empty() ? "" : ", ") + names.back();
  }
  const std::string close = builtin::closest_name(name, names);
  return make_error(ErrorId::kSceneBuiltin, "unknown built-in scene '" + name.substr(0, 40) + "'",
                    (close.empty() ? "" : "did you mean " + close + "? ") + "allowed: " + all);
}

}  // namespace

const std::vector<BuiltinSceneInfo>& builtin_scenes() {
  static const std::vector<BuiltinSceneInfo> kInfos = [] {
    std::vector<BuiltinSceneInfo> infos;
    for (const Builder& builder : kBuilders) {
      infos.push_back(
          {builder.name, builder.description, builtin::describe_options(builder.rules)});
    }
    return infos;
  }();
  return kInfos;
}

Result<Scene> build_builtin_scene(const std::string& spec, const LoadTools& tools) {
  const std::size_t mark = std::min(spec.find('?'), spec.size());
  const std::string name = spec.substr(0, mark);
  const auto builder = std::find_if(kBuilders.begin(), kBuilders.end(),
                                    [&](const Builder& b) { return name == b.name; });
  if (builder == kBuilders.end()) return unknown_scene(name);
  const std::string options = mark < spec.size() ? spec.substr(mark + 1) : std::string();
  auto values = builtin::parse_options(name, options, builder->rules);
  if (!values) return values.error();
  Scene scene = builder->build(*values, tools);
  scene.name = "builtin:" + spec;
  return scene;
}

}  // namespace mirage
