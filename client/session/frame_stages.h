#pragma once
// The stages of a frame, in their order; shading is ShadowStage's, between planning and asking.
// Each has one input and one output; what they share is the session's parts.

#include <cstdint>
#include <vector>

#include "client/hold/asset_need.h"
#include "client/plan/selector.h"

namespace mirage {

struct SessionParts;

/// Where the eye is and will be when what is asked for now is here, and by which tau.
struct Predicted {
  SelectorInput input;
  bool stands = false;   ///< the eye stays, here and ahead
  bool passing = false;  ///< relit tiles are shown for now
};
struct Needs {
  std::vector<TileNeed> tiles;
  std::vector<AssetNeed> meshes;
};

Predicted predict(SessionParts& s, const Camera& camera, std::int64_t now_us);
/// What is drawn. What was touched is in use.
DrawList plan(SessionParts& s, const SelectorInput& input);
/// What is missing.
Needs ask(SessionParts& s, const SelectorInput& input);
/// As much of it as link and server take now.
void send(SessionParts& s, const Predicted& at, const DrawList& list, Needs needs);

}  // namespace mirage
