#include "server/prove/explain.h"

#include <spdlog/fmt/fmt.h>

#include <nlohmann/json.hpp>

#include "server/prepare/prepared_scene.h"
#include "server/prove/left_out.h"
#include "server/prove/need_proof.h"
#include "server/prove/tile_census.h"

namespace mirage {
namespace {

using Json = nlohmann::ordered_json;

constexpr const char* kFull =
    "the same server without need analysis: one shader with every feature, absent maps as neutral "
    "textures, materials as imported, every light that was set, blending on; one kind of tile with "
    "shaded colour, normal, material and 24-bit depth, encoded with its whole window. The same for "
    "both: geometry, samples, depth ahead of alpha tests, measuring, codec";

int number(NeedRule rule) { return static_cast<int>(rule); }

double ratio(double full, double lean) { return lean > 0 ? full / lean : 1; }

std::string lines(const std::vector<LeftOut>& found, const char* indent) {
  std::string out;
  for (const LeftOut& one : found) {
    out += fmt::format("{}{:2} {:<14} {}: {}\n", indent, number(one.rule), need_rule(one.rule).name,
                       one.what, one.why);
  }
  return out;
}

std::string saved_text(const ProofRow& row) {
  return fmt::format("{:.2f} -> {:.2f} ms, {:.0f} -> {:.0f} bytes a tile", row.full_ms, row.lean_ms,
                     row.full_bytes, row.lean_bytes);
}

std::string verdict(const ProofRow& row) {
  return fmt::format("{} tiles, {} components differ; {} ({:.2f} x time, {:.2f} x bytes)",
                     row.tiles, row.differing_components, saved_text(row),
                     ratio(row.full_ms, row.lean_ms), ratio(row.full_bytes, row.lean_bytes));
}

std::string proof_text(const Proof& proof) {
  std::string out = fmt::format("proof, on {}\n  full: {}\n", proof.renderer, kFull);
  std::string last;
  for (const ProofRow& row : proof.rows) {
    if (row.object != last) {
      out += fmt::format("  {}\n", row.object);
      for (const ProofRow& whole : proof.objects) {
        if (whole.object == row.object) out += fmt::format("    all: {}\n", verdict(whole));
      }
    }
    last = row.object;
    out += fmt::format("    {:2} {:<14} without it: {}\n", number(row.rule),
                       need_rule(row.rule).name, verdict(row));
  }
  out += "  what rules, or parts of them, that are not kept would find on these tiles\n";
  for (const DroppedFigure& one : proof.dropped) {
    out += fmt::format("    {:2} {:<14} {} ({:.0f} bytes a tile)\n", number(one.rule),
                       need_rule(one.rule).name, one.measured, one.saved_bytes);
  }
  return out + fmt::format(
                   "  total, mean over these objects: {}; {:.2f} x bytes without normals "
                   "and material on either side\n",
                   verdict(proof.total), ratio(proof.total.full_bytes_lit, proof.total.lean_bytes));
}

Json left_out_json(const std::vector<LeftOut>& found) {
  Json out = Json::array();
  for (const LeftOut& one : found) {
    out.push_back({{"rule", number(one.rule)},
                   {"name", need_rule(one.rule).name},
                   {"left_out", one.what},
                   {"why", one.why}});
  }
  return out;
}

Json rules_json() {
  Json out = Json::array();
  for (const NeedRuleInfo& r : need_rules()) {
    out.push_back({{"rule", number(r.rule)},
                   {"name", r.name},
                   {"detection", r.detection},
                   {"left_out", r.left_out},
                   {"state", r.state == RuleState::kApplied ? "applied" : "dropped"},
                   {"where", r.where},
                   {"proof", r.proof}});
  }
  return out;
}

// `saved` is the larger of both relative gains, in its own unit, so that one number ranks rows.
Json row_json(const std::string& scene, const ProofRow& row) {
  const bool bytes = ratio(row.full_bytes, row.lean_bytes) > ratio(row.full_ms, row.lean_ms);
  return {{"scene", scene},
          {"object", row.object},
          {"rule", number(row.rule)},
          {"name", need_rule(row.rule).name},
          {"left_out", row.left_out},
          {"why", row.why},
          {"differing_components", row.differing_components},
          {"saved", bytes ? row.saved_bytes() : row.saved_ms()},
          {"saved_unit", bytes ? "bytes per tile" : "ms per tile"},
          {"saved_text", saved_text(row)},
          {"saved_ms_per_tile", row.saved_ms()},
          {"saved_bytes_per_tile", row.saved_bytes()},
          {"full_ms_per_tile", row.full_ms},
          {"lean_ms_per_tile", row.lean_ms},
          {"full_bytes_per_tile", row.full_bytes},
          {"lean_bytes_per_tile", row.lean_bytes},
          {"tiles", row.tiles}};
}

Json whole_json(const std::string& scene, const ProofRow& row) {
  return {{"scene", scene},
          {"object", row.object},
          {"tiles", row.tiles},
          {"differing_components", row.differing_components},
          {"full_ms_per_tile", row.full_ms},
          {"lean_ms_per_tile", row.lean_ms},
          {"ms_ratio", ratio(row.full_ms, row.lean_ms)},
          {"full_bytes_per_tile", row.full_bytes},
          {"lean_bytes_per_tile", row.lean_bytes},
          {"bytes_ratio", ratio(row.full_bytes, row.lean_bytes)},
          {"bytes_ratio_same_channels", ratio(row.full_bytes_lit, row.lean_bytes)},
          {"saved_text", saved_text(row)}};
}

void add_proof(const std::string& scene, const Proof& proof, Json& out) {
  out["renderer"] = proof.renderer;
  out["full"] = kFull;
  out["tile_edges"] = proof.edges;
  out["lighting"] = proof.lighting;
  for (const ProofRow& row : proof.rows) out["rows"].push_back(row_json(scene, row));
  for (const ProofRow& row : proof.objects) out["proven"].push_back(whole_json(scene, row));
  out["total"] = whole_json(scene, proof.total);
  for (const DroppedFigure& one : proof.dropped) {
    out["dropped"].push_back({{"rule", number(one.rule)},
                              {"name", need_rule(one.rule).name},
                              {"measured", one.measured},
                              {"saved_bytes_per_tile", one.saved_bytes}});
  }
}

}  // namespace

std::string explain_text(const PreparedScene& prepared, bool shadows, const Proof* proof) {
  const Scene& scene = prepared.scene;
  std::string text = fmt::format("{}: {} objects, {} instances, {} triangles; {} lights\n",
                                 scene.name, scene.objects.size(), scene.instances.size(),
                                 scene.triangles(), scene.lighting.lights.size());
  text += "left out of every object\n" + lines(left_out_of_scene(prepared, shadows), "    ");
  for (const ObjectClass& one : object_classes(prepared, scene.lighting)) {
    text +=
        fmt::format("left out of {}\n{}", class_name(prepared, one), lines(one.left_out, "    "));
  }
  return text + (proof ? proof_text(*proof) : std::string());
}

std::string explain_json(const PreparedScene& prepared, bool shadows, const Proof* proof) {
  const Scene& scene = prepared.scene;
  Json out;
  out["scene"] = scene.name;
  out["revision"] = fmt::format("{:016x}", prepared.revision);
  out["left_out"] = left_out_json(left_out_of_scene(prepared, shadows));
  out["rows"] = Json::array();
  out["proven"] = Json::array();
  out["objects"] = Json::array();
  for (const ObjectClass& one : object_classes(prepared, scene.lighting)) {
    Json names = Json::array();
    for (const std::size_t i : one.objects) names.push_back(object_name(prepared, i));
    out["objects"].push_back({{"object", class_name(prepared, one)},
                              {"objects", names},
                              {"left_out", left_out_json(one.left_out)}});
  }
  out["rules"] = rules_json();
  if (proof) add_proof(scene.name, *proof, out);
  return out.dump(2, ' ', false, Json::error_handler_t::replace) + "\n";
}

}  // namespace mirage
