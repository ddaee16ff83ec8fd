#pragma once
// What all parts of the report share: the renderer, the scenes with their servers, the page.

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

/// What was meant to be measured and was not: told, never dropped (numerics.md section 1).
struct Omission {
  std::string part, what, why;
};

/// A scene, its server if it is one of ours, and its truth.
struct OpenScene {
  std::string name;
  std::string url;
  std::unique_ptr<ServerProcess> server;
  std::unique_ptr<TruthSource> truth;

  ~OpenScene();

  /// A walk, or once around what is a single thing to look at.
  std::string path() const;
};

struct Context {
  const ReportOptions& options;
  Plotter plotter;
  std::unique_ptr<SessionRunner> runner{};  ///< made when first needed
  Progress progress{};
  Page page{};
  std::vector<Omission> omissions{};
  std::vector<std::string> failed_checks{};  ///< of what must hold
  std::map<std::string, std::unique_ptr<OpenScene>> scenes{};

  /// The GL context and its renderer. Errors kGraphics….
  Result<SessionRunner*> graphics();
  /// Starts the scene's server, unless it runs, and learns the scene. With --url: that server's,
  /// whatever `name` says. Errors as ServerProcess and TruthSource.
  Result<OpenScene*> open(const std::string& name);
  /// The same of one of the part's own scenes: nullptr and an omission if it cannot be had. That of
  /// the command line is an error then.
  Result<OpenScene*> open_own(const std::string& part, const std::string& name);
  /// Ends its server, if it is one of ours, and forgets its truth.
  void close(const std::string& name);
  /// The scenes to measure: the user's one, or the part's own.
  std::vector<std::string> scenes_or(const std::vector<std::string>& own) const;
  /// Puts a plot on the page, or says why it is not there.
  void plot(const std::string& name, const std::vector<Panel>& panels, int columns,
            const std::string& caption);
  std::string path(const std::string& file) const { return options.out_dir + "/" + file; }
  void omit(const std::string& part, const std::string& what, const std::string& why) {
    omissions.push_back({part, what, why});
  }

 private:
  /// With --url all names are of one scene.
  std::string key_of(const std::string& name) const {
    return options.url.empty() ? name : options.url;
  }
};

/// `git describe` of the source this was built from.
std::string source_commit();
std::string hex64(std::uint64_t value);

}  // namespace mirage
