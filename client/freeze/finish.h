#pragma once
// The end of a freeze: what stays within the budget, the page, the index, and the error of it all.

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "client/freeze/eyes.h"
#include "client/freeze/frozen_part.h"
#include "protocol/output/output_folder.h"

namespace mirage {

class ServerProcess;

struct FinishContext {
  const ServerProcess& server;
  std::uint64_t revision = 0;
  std::size_t parts = 0;
};

/// Writes page and index of a folder whose files are `part`'s. It looks at the folder from all
/// eyes, and between them, to tell its error. Errors kIo, kUsage: the budget holds next to nothing.
Result<void> finish(OutputFolder& store, const FreezeOptions& options, const FinishContext& context,
                    const FrozenPart& part, const std::vector<EyePart>& eyes);

/// True if the folder was finished with these options and all its files are right.
bool is_finished(const OutputFolder& store, const FreezeOptions& options, std::uint64_t revision);
/// Returns revision and settings of a finished folder; nullopt: it is none.
std::optional<std::string> settings_of(const OutputFolder& store);

}  // namespace mirage
