#pragma once
#include "server/scene/stage_progress.h"
#include "server/scene/workers.h"

namespace mirage {

class CacheDirectory;

/// What whoever makes a scene may use.
struct LoadTools {
  const Workers& workers;
  CacheDirectory* cache = nullptr;  ///< nullptr: all is made
  StageProgress::Tell progress = {};
};

}  // namespace mirage
