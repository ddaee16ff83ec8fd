#pragma once
#include "server/base/stage_progress.h"
#include "server/base/workers.h"

namespace mirage {

class CacheDirectory;

/// Tools that glTF import and built-in scenes may use.
struct LoadTools {
  const Workers& workers;
  CacheDirectory* cache = nullptr;  ///< nullptr: everything is computed anew
  StageProgress::Tell progress = {};
};

}  // namespace mirage
