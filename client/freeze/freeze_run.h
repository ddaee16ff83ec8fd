#pragma once
// Freeze run: starts a server, looks from all eyes part by part, and finishes the folder once all
// parts are there.
// Input:  options.
// Output: the folder, and a line of figures.
// Thread: the caller's.
// Full:   a full disk ends the run; the next one goes on where it was.

#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "client/freeze/eyes.h"
#include "client/freeze/frozen_part.h"
#include "client/freeze/options.h"
#include "protocol/output/output_folder.h"

namespace mirage {

class ServerProcess;

class FreezeRun {
 public:
  explicit FreezeRun(const FreezeOptions& options);
  ~FreezeRun();
  /// Runs to the end. Errors: kUsage, kIo, the server's own.
  Result<void> run();

 private:
  /// A part to make: poses, and whether the client may have geometry.
  struct Task {
    EyePart eyes;
    bool geometry = true;
  };
  Result<void> learn_scene();
  Result<void> check_settings();
  Result<void> make_parts();
  Result<FrozenPart> make(const Task& task, bool write);
  /// Returns a part that an earlier run has made, if all its files are right.
  std::optional<FrozenPart> made(std::size_t index) const;
  Result<void> estimate();
  void tell(std::size_t done, std::size_t all) const;

  const FreezeOptions& o_;
  std::optional<OutputFolder> store_;
  std::unique_ptr<ServerProcess> server_;
  std::uint64_t revision_ = 0;
  std::vector<Task> tasks_;
  FrozenPart all_;
};

/// Returns the name of a part's file in the working folder.
std::string part_name(std::size_t index);

}  // namespace mirage
