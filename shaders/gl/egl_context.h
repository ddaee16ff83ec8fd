#pragma once
// A GL context without a window: EGL on the surfaceless platform (software) or on a device (GPU).

#include <string>
#include <vector>

#include "protocol/base/result.h"

namespace mirage::gl {

struct EglDevice {
  std::string name;      ///< what `--device` takes: "surfaceless", "device0", …
  std::string renderer;  ///< GL_RENDERER, or why it cannot be used
  bool usable = false;
};

/// Every device a context could be made on, tried out.
std::vector<EglDevice> list_egl_devices();

class EglContext {
 public:
  EglContext() = default;
  EglContext(const EglContext&) = delete;
  EglContext& operator=(const EglContext&) = delete;
  EglContext(EglContext&& other) noexcept;
  EglContext& operator=(EglContext&& other) noexcept;
  ~EglContext();

  /// `device`: "auto" (a usable GPU, else surfaceless), or a name from list_egl_devices().
  /// The context is current on the calling thread. `embedded`: OpenGL ES 3, as in a browser,
  /// instead of OpenGL 3.3. Error kGraphicsDevice.
  static Result<EglContext> create(const std::string& device, bool embedded = false);

  void make_current();
  void release_current();
  /// GL_RENDERER and version.
  std::string description() const;
  bool software() const { return software_; }

 private:
  void* display_ = nullptr;
  void* context_ = nullptr;
  bool software_ = true;
  bool embedded_ = false;
};

}  // namespace mirage::gl
