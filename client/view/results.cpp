#include "client/view/results.h"

#include <filesystem>
#include <fstream>

#include "client/host/client_host.h"
#include "client/plan/predictor.h"
#include "client/scene/scene_view.h"
#include "client/session/client_session.h"
#include "client/view/explain_frame.h"

namespace mirage {
namespace {

Result<void> write_text(const std::string& path, const std::string& text) {
  std::ofstream file(path, std::ios::binary);
  file << text;
  file.close();
  if (!file) return make_error(ErrorId::kIo, "cannot write '" + path + "'");
  return {};
}

}  // namespace

SessionStats::Final end_of(const ClientHost& host) {
  const ClientSession& session = host.session();
  SessionStats::Final end;
  end.home = session.scene().home;
  end.traffic = host.traffic();
  end.tiles = session.tiles();
  end.codecs = session.codecs();
  end.prediction = session.predictor().error();
  end.uploads = session.uploads();
  end.views = session.views();
  end.scene = session.scene().name;
  end.server = session.scene().renderer;
  return end;
}

Result<void> write_results(const ResultFiles& files, const SessionStats& stats,
                           const SessionStats::Final& end, const ClientSession& session,
                           const FrameRecorder& recorder) {
  if (!files.trace.empty()) {
    const std::string trace = trace_json(session.lives(), recorder);
    if (Result<void> r = write_text(files.trace, trace); !r) return r;
  }
  if (!files.explain.empty()) {
    if (Result<void> r = write_text(files.explain, explain_frame(session)); !r) return r;
  }
  if (files.stats.empty()) return {};
  if (Result<void> r = write_text(files.stats, stats.json(end)); !r) return r;
  std::filesystem::path apart(files.stats);
  apart.replace_extension(".real_time.json");
  return write_text(apart.string(), stats.real_time_json(end, recorder));
}

}  // namespace mirage
