#pragma once
// Missing GPU: why OpenGL runs on the CPU here. A container or a machine without a screen lacks one
// of a few things, each with its own cure.

#include <optional>
#include <string>
#include <vector>

#include "protocol/base/error.h"

namespace mirage::gl {

/// A file by which libglvnd finds a vendor's EGL, such as egl_vendor.d/10_nvidia.json.
struct EglVendor {
  std::string file;
  std::string library;     ///< that the file names
  std::string load_error;  ///< empty: the library loads
};

/// Facts of this machine that decide whether a card draws.
struct GpuFacts {
  bool nvidia_nodes = false;              ///< /dev/nvidia0, …
  std::vector<std::string> render_nodes;  ///< /dev/dri/renderD128, …
  std::vector<std::string> closed_nodes;  ///< of these, nodes that this user may not open
  std::vector<EglVendor> vendors;
  std::optional<std::string> nvidia_capabilities;  ///< NVIDIA_DRIVER_CAPABILITIES, if it is set
};

/// Looks at /dev, the environment and the folders of EGL vendor files.
GpuFacts gpu_facts();

/// Returns what keeps the card from drawing, what comes first first; never empty. Each is an error
/// kGraphicsDevice with its cure as hint.
std::vector<Error> why_no_gpu(const GpuFacts& facts);

}  // namespace mirage::gl
