#include "tests/bench/bench.h"

#include <time.h>

#include "protocol/base/quantile.h"

namespace mirage::bench {

namespace {

double now_s(Time time) {
  timespec t{};
  clock_gettime(time == Time::kCpu ? CLOCK_PROCESS_CPUTIME_ID : CLOCK_MONOTONIC, &t);
  return static_cast<double>(t.tv_sec) + 1e-9 * static_cast<double>(t.tv_nsec);
}

}  // namespace

double seconds(Time time, const std::function<void()>& work) {
  const double began = now_s(time);
  work();
  return now_s(time) - began;
}

Middle middle(std::vector<double> samples) {
  Middle out;
  out.median = quantile(samples, 0.5);
  const double range = quantile(samples, 0.75) - quantile(samples, 0.25);
  out.spread_pct = out.median > 0 ? 50 * range / out.median : 0;
  return out;
}

Pair in_turn(Time time, int rounds, const std::function<void()>& ours,
             const std::function<void()>& beside) {
  ours();
  beside();
  std::vector<double> mine, theirs, ratios;
  for (int i = 0; i < rounds; ++i) {
    mine.push_back(seconds(time, ours));
    theirs.push_back(seconds(time, beside));
    ratios.push_back(theirs.back() / mine.back());
  }
  const Middle ratio = middle(ratios);
  return {quantile(mine, 0.5), quantile(theirs, 0.5), ratio.median, ratio.spread_pct};
}

}  // namespace mirage::bench
