#include "client/web/frame_prices.h"

#include <emscripten.h>

#include <algorithm>

#include "client/door/client.h"
#include "client/draw/frame_target.h"
#include "client/frame/planned_frame.h"
#include "client/price/cost_fit.h"
#include "client/screen/screen.h"
#include "client/session/client_session.h"
#include "shaders/gl/program.h"

namespace mirage {
namespace {

constexpr std::size_t kMostUnpriced = 16;  // frames whose time is not known yet
// Prices rest after this many frames from one pose; if they went on changing, a page at rest would
// draw for ever.
constexpr int kMostOfOnePose = 20;
constexpr int kPacedFrames = 4;
constexpr int kProbeFrames = 2;
constexpr double kMostScaled = 8;  // limit of the probe, which draws only part of what frames have
// Intervals up to this many display periods are the display's.
constexpr double kSameDisplay = 1.25;

}  // namespace

void FramePrices::begin() { programs_ = gl::programs_compiled(); }

void FramePrices::note_drawn(const Pose& pose) {
  // A compilation, also one while taking in what has arrived, happens only once.
  const bool compiled = gl::programs_compiled() != programs_;
  programs_ = gl::programs_compiled();
  ++drawn_frames_;
  const bool same = pose.eye == pose_.eye && pose.rotation == pose_.rotation;
  seen_from_it_ = same ? seen_from_it_ + 1 : 0;
  pose_ = pose;
  drawn_.push_back({drawn_frames_, client_.drawn_work(), compiled});
  if (drawn_.size() > kMostUnpriced) drawn_.pop_front();
}

bool FramePrices::rest() const { return seen_from_it_ > kMostOfOnePose; }

void FramePrices::note_gpu_ms(std::uint64_t frame, double ms) {
  timed_ = true;
  if (rest()) return;
  for (const Drawn& drawn : drawn_) {
    if (drawn.frame != frame || drawn.compiled) continue;
    client_.learn(drawn.work, ms);
  }
}

// Frames are given to the graphics card ahead of time, so one interval belongs to another frame, or
// to several. Only a few intervals together belong to their frames. Within the display's pace they
// say that frames took no longer. Beyond it they say that frames took all of it, because the next
// one was already waiting.
void FramePrices::note_interval_ms(double ms) {
  const bool compiles =
      std::any_of(drawn_.begin(), drawn_.end(), [](const Drawn& drawn) { return drawn.compiled; });
  if (drawn_.empty() || compiles || rest()) {
    paced_ = {};
    return;
  }
  // The display shows a picture at its next refresh after it is ready, half a period later on
  // average.
  client_.session().note_frame_ms(ms - 0.5 * display_ms_);
  paced_.work += drawn_.back().work;
  paced_.ms += ms;
  if (++paced_.frames < kPacedFrames) return;
  FrameWork work = paced_.work;
  for (double& amount : work.amount) amount /= kPacedFrames;
  const double mean = paced_.ms / kPacedFrames;
  paced_ = {};
  const bool in_pace = mean <= kSameDisplay * display_ms_;
  // The graphics card's own clock is more exact.
  if (timed_ || (in_pace && prices().ms_of(work) <= mean)) return;
  client_.learn(work, mean);
}

const CostModel& FramePrices::prices() const { return client_.prices()->model(); }

void FramePrices::probe(const Camera& camera) {
  PlannedFrame nothing;
  nothing.camera = camera;
  nothing.scene = &client_.session().scene();
  nothing.lighting = client_.session().lighting();
  const auto draw = [&] {
    client_.screen().draw(client_.renderer(), nothing);
    client_.screen().shown().read();  // only reading waits for the graphics card here
  };
  draw();  // programs are finished at their first use
  const double began = emscripten_get_now();
  for (int i = 0; i < kProbeFrames; ++i) draw();
  const double ms = (emscripten_get_now() - began) / kProbeFrames;
  const double expected = prices().ms_of(client_.screen().work(nothing));
  if (!(ms > 0) || !(expected > 0)) return;
  CostModel prices = this->prices();
  for (double& price : prices.ms) price *= std::clamp(ms / expected, 1 / kMostScaled, kMostScaled);
  client_.set_prices(prices);
  client_.screen().content_changed();
}

}  // namespace mirage
