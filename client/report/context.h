#pragma once
// Context: what all parts of the report share: the renderer, the scenes with their servers, the
// page.

#include <map>
#include <memory>
#include <string>
#include <vector>

#include "client/report/options.h"
#include "client/report/page.h"
#include "client/report/plot.h"
#include "client/report/progress.h"

namespace mirage {

class ServerProcess;
class SessionRunner;
class TruthSource;

/// Something that was to be measured and was not. It is reported, never dropped (numerics.md
/// section 1).
struct Omission {
  std::string part, what, why;
};

/// A scene, its server if the report started it, and its truth.
struct OpenScene {
  std::string name;
  std::string url;
  std::unique_ptr<ServerProcess> server;
  std::unique_ptr<TruthSource> truth;

  ~OpenScene();

  /// Returns the path: a walk, or once around a scene that is a single thing to look at.
  std::string path() const;
};

struct Context {
  const ReportOptions& options;
  Plotter plotter;
  std::unique_ptr<SessionRunner> runner{};  ///< made when first needed
  Progress progress{};
  Page page{};
  std::vector<Omission> omissions{};
  std::vector<std::string> failed_checks{};  ///< checks that did not hold
  std::map<std::string, std::unique_ptr<OpenScene>> scenes{};

  /// Returns the GL context with its renderer; makes them first. Errors kGraphics….
  Result<SessionRunner*> graphics();
  /// Starts the scene's server unless it runs, and learns the scene. With --url it uses that server
  /// for any `name`. Errors as ServerProcess and TruthSource.
  Result<OpenScene*> open(const std::string& name);
  /// Opens one of the part's own scenes. Returns nullptr, and notes an omission, if it cannot be
  /// opened. For a scene of the command line that is an error.
  Result<OpenScene*> open_own(const std::string& part, const std::string& name);
  /// Ends the scene's server, if the report started it, and forgets its truth.
  void close(const std::string& name);
  /// Returns the scenes to measure: the user's scene, or the part's own.
  std::vector<std::string> scenes_or(const std::vector<std::string>& own) const;
  /// Puts a plot on the page, or says why it is missing.
  void plot(const std::string& name, const std::vector<Panel>& panels, int columns,
            const std::string& caption);
  std::string path(const std::string& file) const { return options.out_dir + "/" + file; }
  void omit(const std::string& part, const std::string& what, const std::string& why) {
    omissions.push_back({part, what, why});
  }

 private:
  /// Returns the key of a scene. With --url all names mean one scene.
  std::string key_of(const std::string& name) const {
    return options.url.empty() ? name : options.url;
  }
};

/// Returns `git describe` of the source that this was built from.
std::string source_commit();
std::string hex64(std::uint64_t value);

}  // namespace mirage
