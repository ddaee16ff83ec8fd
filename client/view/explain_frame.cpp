#include "client/view/explain_frame.h"

#include <nlohmann/json.hpp>

#include "client/plan/alternatives.h"
#include "client/plan/frame_plan.h"
#include "client/price/error_model.h"
#include "client/scene/scene_view.h"

namespace mirage {
namespace {

using nlohmann::ordered_json;

ordered_json way_json(const Choice& choice, double lambda) {
  ordered_json j;
  j["as"] = look_name(choice.look);
  if (choice.look == Look::kMesh) j["level"] = choice.lod;
  j["error"] = choice.error;
  j["ms"] = choice.ms;
  j["cost"] = choice.error + lambda * choice.ms;
  return j;
}

ordered_json thing_json(const ClientSession& session, const Alternatives& thing,
                        const Choice& chosen) {
  const SceneView& scene = session.scene();
  const FramePlan& plan = session.plan();
  ordered_json j;
  j["instance"] = scene.instances[thing.instance].id;
  j["object"] = scene.object_id(thing.instance);
  j["group"] = scene.objects[scene.instances[thing.instance].object].group;
  j["area_px"] = thing.area_px;
  j["chosen"] = way_json(chosen, plan.lambda());
  ordered_json wrongs;
  for (std::size_t k = 0; k < kWrongs; ++k) {
    if (chosen.wrongs[k] != 0) wrongs[wrong_name(static_cast<Wrong>(k))] = chosen.wrongs[k];
  }
  j["chosen"]["error_from"] = wrongs;
  j["chosen"]["fades"] = thing.leaving.has_value() && chosen.fades;
  for (const Choice& way : plan.ways(thing, plan.setting())) {
    j["alternatives"].push_back(way_json(way, plan.lambda()));
  }
  return j;
}

}  // namespace

std::string explain_frame(const ClientSession& session) {
  const FramePlan& plan = session.plan();
  const std::vector<Alternatives>& considered = session.considered();
  const std::vector<Choice>& chosen = plan.choices();
  ordered_json j;
  j["frame"] = session.frame_number();
  j["budget_ms"] = plan.budget_ms();
  j["expected_ms"] = plan.expected_ms();
  j["expected_flip"] = plan.expected_flip();
  j["lambda"] = plan.lambda();
  j["samples"] = plan.setting().samples;
  j["scale"] = plan.setting().scale;
  j["tau_px"] = session.tau_px();
  double error = 0, ms = 0;
  for (const Choice& choice : chosen) {
    error += choice.error;
    ms += choice.ms;
  }
  j["error"] = error;
  j["things_ms"] = ms;
  j["things"] = ordered_json::array();
  for (std::size_t i = 0; i < chosen.size(); ++i) {
    j["things"].push_back(thing_json(session, considered[i], chosen[i]));
  }
  return j.dump(1) + "\n";
}

}  // namespace mirage
