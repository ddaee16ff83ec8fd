#include "client/report/truth_source.h"

#include "client/door/client.h"
#include "client/host/client_host.h"
#include "client/session/client_session.h"
#include "protocol/impostor/lighting_state.h"

namespace mirage {

TruthSource::TruthSource() : client_(std::make_unique<Client>()) {}
TruthSource::~TruthSource() = default;

const SceneView& TruthSource::scene() const { return host_->session().scene(); }
namespace {

template <typename T>
void append(std::string& key, const T& value) {
  key.append(reinterpret_cast<const char*>(&value), sizeof(value));
}

std::string key_of(const Camera& c, std::uint32_t samples, std::uint64_t light) {
  std::string key;
  for (const double v : {c.pose.eye.x, c.pose.eye.y, c.pose.eye.z, c.fov_y}) append(key, v);
  for (int i = 0; i < 4; ++i) append(key, c.pose.rotation[i]);
  for (const std::uint32_t v : {c.width, c.height, samples}) append(key, v);
  append(key, light);
  return key;
}

}  // namespace

Result<std::unique_ptr<TruthSource>> TruthSource::open(const std::string& url) {
  HostOptions options;
  options.url = url;
  options.session.name = "mirage-report truth";
  options.session.animation = false;
  options.session.views = false;
  auto truth = std::make_unique<TruthSource>();
  truth->host_ = std::make_unique<ClientHost>(options, *truth->client_);
  if (Result<void> open = truth->host_->open(); !open) return open.error();
  if (Result<void> told = truth->host_->wait_for_scene(); !told) return told.error();
  return truth;
}

void TruthSource::set_lighting(const Lighting& lighting) {
  if (same_lighting(lighting, host_->session().lighting())) return;
  host_->session().set_lighting(lighting, host_->now_us());
}

Result<ReferencePtr> TruthSource::at(const Camera& camera, std::uint32_t samples) {
  const std::string key = key_of(camera, samples, lighting_hash(host_->session().lighting()));
  const auto kept = kept_.find(key);
  if (kept != kept_.end()) return kept->second;
  Result<ReferenceFrame> frame = host_->reference(camera, samples);
  if (!frame) return frame.error();
  auto shared = std::make_shared<const ReferenceFrame>(frame.take());
  kept_.emplace(key, shared);
  return ReferencePtr(shared);
}

}  // namespace mirage
