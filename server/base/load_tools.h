#pragma once
#include "server/base/stage_progress.h"
#include "server/base/workers.h"

namespace mirage {

class CacheDirectory;

/// What whoever makes a scene may use.
struct LoadTools {
  const Workers& workers;
  CacheDirectory* cache = nullptr;  ///< nullptr: all is made
  StageProgress::Tell progress = {};
};

}  // namespace mirage
