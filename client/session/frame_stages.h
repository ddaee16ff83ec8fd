#pragma once
// Frame stages: the stages of a frame, in their order; shading is ShadowStage's, between planning
// and asking. Each stage has one input and one output. They share the session's parts.

#include <cstdint>
#include <vector>

#include "client/hold/asset_need.h"
#include "client/plan/selector_input.h"
#include "client/plan/tile_need.h"
#include "protocol/impostor/camera.h"

namespace mirage {

struct DrawList;
struct SessionParts;

/// The eye of each view now, and where it will be when what is asked for arrives; and the tau to
/// use.
struct Predicted {
  std::vector<SelectorInput> views;
  bool stands = false;   ///< all eyes stay where they are
  bool passing = false;  ///< relit tiles are shown for now
};
struct Needs {
  std::vector<TileNeed> tiles;
  std::vector<AssetNeed> meshes;
};

Predicted predict(SessionParts& s, const std::vector<Camera>& views, std::int64_t now_us);
/// Decides what is drawn in each view, and marks it as in use.
std::vector<DrawList> plan(SessionParts& s, const Predicted& at);
/// Returns what any view misses; what two of them miss may be there twice.
Needs ask(SessionParts& s, const Predicted& at);
/// Sends as many of the needs as link and server take now.
void send(SessionParts& s, const Predicted& at, const std::vector<DrawList>& lists, Needs needs);

}  // namespace mirage
