#pragma once
// Frame stages: the stages of a frame, in their order; shading is ShadowStage's, between planning
// and asking. Each stage has one input and one output. They share the session's parts.

#include <cstdint>
#include <vector>

#include "client/hold/asset_need.h"
#include "client/plan/selector.h"

namespace mirage {

struct SessionParts;

/// The eye now, and where it will be when what is asked for arrives; and the tau to use.
struct Predicted {
  SelectorInput input;
  bool stands = false;   ///< the eye stays where it is
  bool passing = false;  ///< relit tiles are shown for now
};
struct Needs {
  std::vector<TileNeed> tiles;
  std::vector<AssetNeed> meshes;
};

Predicted predict(SessionParts& s, const Camera& camera, std::int64_t now_us);
/// Decides what is drawn, and marks it as in use.
DrawList plan(SessionParts& s, const SelectorInput& input);
/// Returns what is missing.
Needs ask(SessionParts& s, const SelectorInput& input);
/// Sends as many of the needs as link and server take now.
void send(SessionParts& s, const Predicted& at, const DrawList& list, Needs needs);

}  // namespace mirage
