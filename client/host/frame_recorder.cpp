#include "client/host/frame_recorder.h"

#include <algorithm>
#include <nlohmann/json.hpp>
#include <numeric>

#include "protocol/base/quantile.h"

namespace mirage {
namespace {

using nlohmann::ordered_json;

constexpr double kLate = 1.1;    // budgets; as FramePlan counts
constexpr double kVeryLate = 3;  // budgets
constexpr std::int64_t kSettledUs = 5'000'000;

std::size_t index(FrameStage stage) { return static_cast<std::size_t>(stage); }

std::vector<float> times_of(const std::vector<RecordedFrame>& frames, std::size_t stage) {
  std::vector<float> out;
  out.reserve(frames.size());
  for (const RecordedFrame& frame : frames) out.push_back(frame.ms[stage]);
  return out;
}

ordered_json quantiles_of(const std::vector<float>& ms) {
  const auto at = [&](double q) {
    return ms.empty() ? ordered_json(nullptr) : ordered_json(quantile(ms, q));
  };
  return {{"p50", at(0.5)}, {"p95", at(0.95)}, {"p99", at(0.99)}, {"max", at(1)}};
}

ordered_json missing_share(const std::vector<RecordedFrame>& frames, std::int64_t from_us) {
  std::uint64_t visible = 0, placeholders = 0;
  for (const RecordedFrame& frame : frames) {
    if (frame.began_us < from_us) continue;
    visible += frame.visible;
    placeholders += frame.placeholders;
  }
  if (visible == 0) return nullptr;
  return static_cast<double>(placeholders) / static_cast<double>(visible);
}

// Returns the stage that made a frame late.
FrameStage cause(const RecordedFrame& frame, const std::array<float, kFrameStages>& usual) {
  std::size_t worst = 0;
  for (std::size_t stage = 1; stage < kFrameStages; ++stage) {
    if (frame.ms[stage] - usual[stage] > frame.ms[worst] - usual[worst]) worst = stage;
  }
  return static_cast<FrameStage>(worst);
}

}  // namespace

const char* frame_stage_name(FrameStage stage) {
  constexpr const char* kNames[] = {"receive", "upload", "plan", "compile",
                                    "draw",    "finish", "show", "other"};
  static_assert(std::size(kNames) == kFrameStages);
  return kNames[index(stage)];
}

double RecordedFrame::all_ms() const { return std::accumulate(ms.begin(), ms.end(), 0.0); }

bool RecordedFrame::late() const { return budget_ms > 0 && all_ms() > kLate * budget_ms; }

void FrameRecorder::begin() {
  began_us_ = lap_us_ = clock_.now_us();
  if (first_us_ < 0) first_us_ = began_us_;
  ms_ = {};
}

void FrameRecorder::lap(FrameStage stage, double upload_ms) {
  const std::int64_t now_us = clock_.now_us();
  ms_[index(stage)] += static_cast<float>(static_cast<double>(now_us - lap_us_) * 1e-3 - upload_ms);
  ms_[index(FrameStage::kUpload)] += static_cast<float>(upload_ms);
  lap_us_ = now_us;
}

void FrameRecorder::end(RecordedFrame frame) {
  lap(FrameStage::kOther);
  frame.began_us = began_us_ - first_us_;
  frame.ms = ms_;
  frames_.push_back(frame);
}

FrameRecorder::StageTimes FrameRecorder::medians() const {
  StageTimes out{};
  for (std::size_t stage = 0; stage < kFrameStages; ++stage) {
    out[stage] = static_cast<float>(quantile(times_of(frames_, stage), 0.5));
  }
  return out;
}

ordered_json FrameRecorder::summary() const {
  ordered_json out, stages, causes;
  for (std::size_t stage = 0; stage < kFrameStages; ++stage) {
    stages[frame_stage_name(static_cast<FrameStage>(stage))] =
        quantiles_of(times_of(frames_, stage));
    causes[frame_stage_name(static_cast<FrameStage>(stage))] = 0;
  }
  const StageTimes usual = medians();
  std::vector<float> all, settled;
  std::size_t late = 0, very_late = 0;
  for (const RecordedFrame& frame : frames_) {
    all.push_back(static_cast<float>(frame.all_ms()));
    if (frame.began_us >= kSettledUs) settled.push_back(all.back());
    if (!frame.late()) continue;
    ++late;
    if (&frame != &frames_.front() && frame.all_ms() > kVeryLate * frame.budget_ms) ++very_late;
    ordered_json& count = causes[frame_stage_name(cause(frame, usual))];
    count = count.get<int>() + 1;
  }
  out["frames"] = frames_.size();
  out["ms"] = quantiles_of(all);
  out["ms_after_5s"] = quantiles_of(settled);
  out["stage_ms"] = stages;
  out["late"] = late;  // longer than 1.1 budgets
  out["late_causes"] = causes;
  out["over_3_budgets"] = very_late;  // after the first picture
  out["placeholder_fraction"] = missing_share(frames_, 0);
  out["placeholder_fraction_after_5s"] = missing_share(frames_, kSettledUs);
  return out;
}

ordered_json FrameRecorder::json() const {
  ordered_json out = ordered_json::array();
  const StageTimes usual = medians();
  for (const RecordedFrame& frame : frames_) {
    ordered_json one = {{"began_us", frame.began_us}, {"ms", frame.all_ms()}};
    for (std::size_t stage = 0; stage < kFrameStages; ++stage) {
      one[std::string(frame_stage_name(static_cast<FrameStage>(stage))) + "_ms"] = frame.ms[stage];
    }
    one["budget_ms"] = frame.budget_ms;
    one["scale"] = frame.scale;
    one["visible"] = frame.visible;
    one["placeholders"] = frame.placeholders;
    one["late"] =
        frame.late() ? ordered_json(frame_stage_name(cause(frame, usual))) : ordered_json(nullptr);
    out.push_back(one);
  }
  return out;
}

}  // namespace mirage
