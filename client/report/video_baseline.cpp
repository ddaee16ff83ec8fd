#include "client/report/video_baseline.h"

#include <cmath>

#include "client/report/video_codec.h"
#include "client/report/video_link.h"
#include "client/scene/scene_view.h"

namespace mirage {
namespace {

constexpr std::uint32_t kVideoSamples = 2;  // along each axis of a pixel
constexpr double kGrantedRenderMs = 10;

// Returns the picture before the first frame: the grey that a session shows, and no object.
std::vector<std::uint8_t> nothing_yet(std::size_t pixels) {
  std::vector<std::uint8_t> out(pixels * 4, 128);
  for (std::size_t i = 3; i < out.size(); i += 4) out[i] = 0;
  return out;
}

struct Stream {
  int first = 0;
  std::vector<Camera> cameras;     // of every frame of the path
  std::vector<CodedFrame> frames;  // from `first` on; alpha as rendered, for the masks
  std::vector<std::int64_t> arrivals;
  double mbps = 0;
};

Result<Stream> stream(const RunSpec& spec, TruthSource& truth, const CameraPath& path) {
  Stream s;
  s.first = std::min(first_video_frame(spec.net, spec.fps), spec.frames);
  std::vector<ReferencePtr> rendered;
  std::vector<const std::uint8_t*> source;
  for (int f = 0; f < spec.frames; ++f) {
    s.cameras.push_back(
        SessionRunner::camera_at(path, f / spec.fps, truth.scene(), spec.width, spec.height));
    if (f < s.first) continue;
    const Result<ReferencePtr> frame = truth.at(s.cameras.back(), kVideoSamples);
    if (!frame) return frame.error();
    rendered.push_back(*frame);
    source.push_back(rendered.back()->rgba.data());
  }
  Result<CodedVideo> coded =
      code_video(source, spec.width, spec.height, spec.fps, spec.net.rate_mbps);
  if (!coded) return coded.error();
  std::vector<std::size_t> bytes;
  std::size_t total = 0;
  for (std::size_t i = 0; i < source.size(); ++i) {
    CodedFrame& frame = coded->frames[i];
    for (std::size_t a = 3; a < frame.rgba.size(); a += 4) frame.rgba[a] = source[i][a];
    bytes.push_back(frame.bytes);
    total += frame.bytes + kVideoFraming + kPoseBytes;
  }
  const VideoTiming timing{spec.fps, kGrantedRenderMs, coded->encode_ms, coded->decode_ms};
  s.arrivals = video_arrivals(bytes, s.first, timing, spec.net);
  s.frames = std::move(coded->frames);
  s.mbps = 8e-6 * static_cast<double>(total) * spec.fps / spec.frames;
  return s;
}

}  // namespace

Result<VideoRuns> run_video(const RunSpec& spec, TruthSource& truth) {
  const SceneView& scene = truth.scene();
  const Result<CameraPath> path =
      CameraPath::create(spec.path, scene.home, scene.bounds_center, scene.bounds_radius);
  if (!path) return path.error();
  const Result<Stream> streamed = stream(spec, truth, *path);
  if (!streamed) return streamed.error();
  const Stream& s = *streamed;
  VideoRuns out;
  out.plain.mbps = out.warped.mbps = s.mbps;
  if (!s.arrivals.empty()) {
    // The first image is shown with the first display frame after its arrival.
    out.plain.first_image_ms = out.warped.first_image_ms =
        std::ceil(1e-6 * static_cast<double>(s.arrivals[0]) * spec.fps) / spec.fps * 1e3;
  }
  const std::size_t pixels =
      static_cast<std::size_t>(spec.width) * static_cast<std::size_t>(spec.height);
  const std::vector<std::uint8_t> nothing = nothing_yet(pixels);
  for (const int f : spec.compared) {
    const Camera& camera = s.cameras[static_cast<std::size_t>(f)];
    const double seconds = f / spec.fps;
    const Result<ReferencePtr> due = truth.at(camera, spec.truth_samples);
    if (!due) return due.error();
    const ImageView view{camera.width, camera.height, (*due)->rgba.data()};
    const auto flip = [&](const std::vector<std::uint8_t>& seen) {
      return measure_images(view, {camera.width, camera.height, seen.data()}).flip_mean.value_or(0);
    };
    std::size_t shown = s.arrivals.size();
    for (std::size_t i = 0; i < s.arrivals.size(); ++i) {
      if (s.arrivals[i] <= std::llround(seconds * 1e6)) shown = i;
    }
    if (shown == s.arrivals.size()) {  // nothing has arrived; its pose is as old as the session
      const LatencySample blank{seconds, flip(nothing), seconds * 1e3, 1};
      out.plain.samples.push_back(blank);
      out.warped.samples.push_back(blank);
      continue;
    }
    const int posed = s.first + static_cast<int>(shown);
    const double age_ms = (f - posed) * 1e3 / spec.fps;
    std::size_t outside = 0;
    const std::vector<std::uint8_t>& late = s.frames[shown].rgba;
    const std::vector<std::uint8_t> turned =
        timewarp(late, s.cameras[static_cast<std::size_t>(posed)], camera, outside);
    out.plain.samples.push_back({seconds, flip(late), age_ms, 0});
    out.warped.samples.push_back({seconds, flip(turned), age_ms,
                                  static_cast<double>(outside) / static_cast<double>(pixels)});
  }
  return out;
}

}  // namespace mirage
