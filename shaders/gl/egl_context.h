#pragma once
// A GL context without a window: EGL on the surfaceless platform (software) or on a device (GPU).

#include <string>
#include <vector>

#include "protocol/base/result.h"

namespace mirage::gl {

struct EglDevice {
  std::string name;      ///< for `--device`: "surfaceless", "device0", …
  std::string renderer;  ///< GL_RENDERER, or why the device is unusable
  bool usable = false;
};

/// Returns every device on which a context could be made; each is tested.
std::vector<EglDevice> list_egl_devices();

class EglContext {
 public:
  EglContext() = default;
  EglContext(const EglContext&) = delete;
  EglContext& operator=(const EglContext&) = delete;
  EglContext(EglContext&& other) noexcept;
  EglContext& operator=(EglContext&& other) noexcept;
  ~EglContext();

  /// Creates a context and makes it current on the calling thread. `device`: "auto" (a usable GPU,
  /// else surfaceless), or a name from list_egl_devices(). `embedded`: OpenGL ES 3, as in a
  /// browser, instead of OpenGL 3.3. Error kGraphicsDevice.
  static Result<EglContext> create(const std::string& device, bool embedded = false);

  void make_current();
  /// Returns GL_RENDERER and GL_VERSION.
  std::string description() const;
  bool software() const { return software_; }

 private:
  void* display_ = nullptr;
  void* context_ = nullptr;
  bool software_ = true;
  bool embedded_ = false;
};

}  // namespace mirage::gl
