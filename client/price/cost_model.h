#pragma once
// What work costs on a device: milliseconds for each kind of it (frame_work.h).

#include <optional>
#include <string>
#include <vector>

#include "client/price/frame_work.h"

namespace mirage {

struct CostModel {
  std::array<double, kWorks> ms{};  ///< for one of each kind, finite and >= 0

  double& operator[](Work kind) { return ms[static_cast<std::size_t>(kind)]; }
  double operator[](Work kind) const { return ms[static_cast<std::size_t>(kind)]; }
  /// Of a frame, or a part of it.
  double ms_of(const FrameWork& work) const;
};

/// software, laptop or phone; nullopt for any other name.
std::optional<CostModel> device_model(const std::string& name);
std::vector<std::string> device_model_names();

}  // namespace mirage
