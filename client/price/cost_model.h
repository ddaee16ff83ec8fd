#pragma once
// Cost model: what work costs on a device, in milliseconds for each kind of work (frame_work.h).

#include <optional>
#include <string>
#include <vector>

#include "client/price/frame_work.h"

namespace mirage {

struct CostModel {
  std::array<double, kWorks> ms{};  ///< ms for one unit of each kind; finite and >= 0

  double& operator[](Work kind) { return ms[static_cast<std::size_t>(kind)]; }
  double operator[](Work kind) const { return ms[static_cast<std::size_t>(kind)]; }
  /// Returns the milliseconds of the work of a frame, or of a part of it.
  double ms_of(const FrameWork& work) const;
};

/// Returns the model of a device: software, laptop or phone; nullopt for any other name.
std::optional<CostModel> device_model(const std::string& name);
std::vector<std::string> device_model_names();

}  // namespace mirage
