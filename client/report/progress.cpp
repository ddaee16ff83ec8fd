#include "client/report/progress.h"

#include <spdlog/fmt/fmt.h>

#include <cstdio>

namespace mirage {

void Progress::begin(const std::string& part, std::size_t steps) {
  part_ = part;
  steps_ = steps;
  done_ = 0;
  began_s_ = elapsed_s();
}

void Progress::step(const std::string& what) {
  const double now = elapsed_s();
  std::string rest;
  if (done_ > 0 && steps_ >= done_) {
    const double each = (now - began_s_) / static_cast<double>(done_);
    rest = fmt::format(", about {:.0f} s left of this part",
                       each * static_cast<double>(steps_ - done_));
  }
  ++done_;
  const std::string line =
      fmt::format("{:6.1f} s  {} {} of {}: {}{}\n", now, part_, done_, steps_, what, rest);
  std::fputs(line.c_str(), stderr);
}

}  // namespace mirage
