#include "server/doctor.h"

#include <fmt/format.h>
#include <openssl/pem.h>
#include <openssl/x509.h>
#include <spdlog/spdlog.h>
#include <sys/resource.h>

#include <chrono>
#include <cstdio>
#include <filesystem>
#include <memory>
#include <thread>

#include "protocol/wire/tile_address.h"
#include "server/net/endpoint.h"
#include "server/options.h"
#include "server/prepare/prepared_scene.h"
#include "server/session/session.h"
#include "server/source/shared_store.h"
#include "server/stage/machine_share.h"
#include "server/stage/pipeline.h"
#include "shaders/gl/egl_context.h"
#include "shaders/gl/missing_gpu.h"
#include "shaders/gl/renderer.h"

namespace mirage {
namespace {

namespace fs = std::filesystem;
constexpr rlim_t kGoodDescriptors = 4096;
constexpr std::uint64_t kGoodSpace = 1u << 30;
constexpr std::int64_t kPatienceUs = 60'000'000;

class Findings {
 public:
  void ok(const std::string& what, const std::string& text) { print("ok", what, text); }
  void warn(const std::string& what, const std::string& text) { print("warn", what, text); }
  void fail(const std::string& what, const Error& error) {
    print("FAIL", what, error.text + (error.hint.empty() ? "" : " (" + error.hint + ")"));
    if (code_ == 0) code_ = static_cast<int>(exit_code(error.id));
  }
  int code() const { return code_; }

 private:
  static void print(const char* how, const std::string& what, const std::string& text) {
    std::printf("%-4s  %-12s %s\n", how, what.c_str(), text.c_str());
    std::fflush(stdout);
  }
  int code_ = 0;
};

/// Says why the CPU draws, if it does. Without --require-gpu that is only slow.
void look_for_card(const ServerOptions& options, bool card, Findings& found) {
  if (card) return found.ok("card", "a graphics card draws");
  for (const Error& why : gl::why_no_gpu(gl::gpu_facts())) {
    options.require_gpu ? found.fail("card", why)
                        : found.warn("card", "the CPU draws: " + why.text + " (" + why.hint + ")");
  }
}

void look_at_devices(const ServerOptions& options, Findings& found) {
  int usable = 0;
  bool card = false;
  for (const gl::EglDevice& device : gl::list_egl_devices()) {
    usable += device.usable ? 1 : 0;
    card = card || (device.usable && !gl::is_software(device.renderer));
    const std::string text = device.name + ": " + device.renderer;
    device.usable ? found.ok("device", text) : found.warn("device", text);
  }
  look_for_card(options, card, found);
  if (usable > 0) return;
  found.fail("device", make_error(ErrorId::kGraphicsDevice, "no EGL device draws",
                                  "apt install libgl1-mesa-dri libegl1"));
}

void look_at_descriptors(Findings& found) {
  rlimit limit{};
  getrlimit(RLIMIT_NOFILE, &limit);
  const std::string text = fmt::format("{} may be open at a time", limit.rlim_max);
  if (limit.rlim_max >= kGoodDescriptors) return found.ok("descriptors", text);
  found.warn("descriptors", text + ", one a client (ulimit -Hn, LimitNOFILE= raise it)");
}

void look_at_cache(const ServerOptions& options, Findings& found) {
  const std::string& folder = options.cache_dir;
  if (folder.empty()) return found.ok("cache", "none: tiles are kept in memory only (--cache-dir)");
  std::error_code failed;
  fs::create_directories(folder, failed);
  const std::string probe = folder + "/doctor.part";
  std::FILE* const file = std::fopen(probe.c_str(), "wb");
  if (!file) {
    return found.fail("cache", make_error(ErrorId::kIo, "'" + folder + "' cannot be written"));
  }
  std::fclose(file);
  fs::remove(probe, failed);
  const std::uint64_t space = fs::space(folder, failed).available;
  const std::string text = fmt::format("'{}', {} MiB are free", folder, space >> 20);
  space >= kGoodSpace ? found.ok("cache", text) : found.warn("cache", text);
}

void look_at_certificate(const ServerOptions& options, Findings& found) {
  const std::string& path = options.endpoint.tls_cert;
  if (path.empty()) return found.ok("certificate", "none: ws:// without TLS (--tls-cert)");
  std::FILE* const file = std::fopen(path.c_str(), "rb");
  X509* const certificate = file ? PEM_read_X509(file, nullptr, nullptr, nullptr) : nullptr;
  if (file) std::fclose(file);
  if (!certificate) {
    return found.fail("certificate", make_error(ErrorId::kUsage, "'" + path + "' holds none"));
  }
  int days = 0, seconds = 0;
  ASN1_TIME_diff(&days, &seconds, nullptr, X509_get0_notAfter(certificate));
  X509_free(certificate);
  const std::string text = fmt::format("'{}' ends in {} days", path, days);
  if (days < 0 || seconds < 0) {
    return found.fail("certificate", make_error(ErrorId::kUsage, "'" + path + "' has ended"));
  }
  days > 14 ? found.ok("certificate", text) : found.warn("certificate", text);
}

void look_at_store(const ServerOptions& options, const Clock& clock, Findings& found) {
  if (!options.store) return found.ok("store", "none is shared (--store)");
  Result<std::unique_ptr<TileSource>> store = open_shared_store(*options.store, clock);
  if (!store) return found.fail("store", store.error());
  // The probe relies on a held claim being visible to others. A store that does not answer holds
  // none.
  const TileId probe{1, static_cast<std::uint64_t>(clock.now_us())};
  Result<std::unique_ptr<TileSource>> other = open_shared_store(*options.store, clock);
  const bool answers = (*store)->claim(probe) && other && !(*other)->claim(probe);
  answers
      ? found.ok("store", options.store->name() + " answers")
      : found.warn("store", options.store->name() + " does not answer: tiles are rendered here");
}

/// Renders one tile through the same stages as a client's tile.
void render_one(const ServerOptions& options, const std::shared_ptr<const PreparedScene>& scene,
                Findings& found) {
  const SteadyClock clock;
  Pipeline pipeline(clock, 1u << 24, {});
  const Result<std::string> renderer = pipeline.start(scene, options.render, options.encoders);
  if (!renderer) return found.fail("renderer", renderer.error());
  found.ok("renderer", *renderer);
  found.ok("encoders",
           fmt::format("{} on {} cores (--encoders)", pipeline.encoders(), usable_cores()));
  SessionHub hub(scene, options.session, pipeline.queues);
  Endpoint endpoint(hub, pipeline.queues);
  const Result<void> listening = endpoint.listen(options.endpoint);
  listening ? found.ok("address", options.endpoint.address.url(!options.endpoint.tls_cert.empty(),
                                                               endpoint.port()))
            : found.fail("address", listening.error());
  TileAddress address;
  address.cell = {3, 4, 4};
  address.distance = {2, 8};
  address.size_class = 6;
  address.channels = kLitTile;
  address.phase = scene->animated() ? 1 : 0;
  const std::int64_t start_us = clock.now_us();
  hub.get(address);
  std::vector<GotTile> got = hub.take_got();
  while (got.empty() && !hub.failure() && clock.now_us() - start_us < kPatienceUs) {
    while (std::optional<Completion> done = pipeline.queues.completions.try_pop()) {
      hub.complete(std::move(*done));
    }
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
    got = hub.take_got();
  }
  const double ms = static_cast<double>(clock.now_us() - start_us) * 1e-3;
  if (!got.empty() && !got[0].message.empty()) {
    found.ok("tile",
             fmt::format("128 x 128 texels, {} bytes, in {:.1f} ms", got[0].message.size(), ms));
  } else if (!got.empty()) {
    found.warn("tile", "the scene's first instance has none");
  } else {
    found.fail("tile", hub.failure().value_or(make_error(ErrorId::kGraphicsGl, "none came")));
  }
  pipeline.stop();
}

}  // namespace

int run_doctor(const ServerOptions& options) {
  spdlog::set_level(spdlog::level::off);  // the doctor prints its own lines
  Findings found;
  const SteadyClock clock;
  look_at_devices(options, found);
  look_at_descriptors(found);
  look_at_cache(options, found);
  look_at_certificate(options, found);
  look_at_store(options, clock, found);
  options.session.access.open() ? found.warn("tokens", "none: everybody who reaches it is a client")
                                : found.ok("tokens", "'" + options.token_file + "'");
  Result<std::shared_ptr<const PreparedScene>> scene =
      load_scene(options.scene, {.strict = options.strict,
                                 .megabytes = options.scene_mb,
                                 .environment = options.environment,
                                 .studio = options.look == "studio"});
  if (!scene) {
    found.fail("scene", scene.error());
  } else {
    found.ok("scene", fmt::format("{}: {} objects, {} triangles", options.scene,
                                  (*scene)->scene.objects.size(), (*scene)->scene.triangles()));
    render_one(options, scene.take(), found);
  }
  return found.code();
}

}  // namespace mirage
