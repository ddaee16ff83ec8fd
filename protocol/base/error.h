#pragma once
// Errors as an enumerated list. One table maps id -> exit code -> WebSocket close code;
// tests assert ids, never texts.

#include <string>
#include <string_view>
#include <utility>

namespace mirage {

/// Process exit codes of every program (a contract: scripts rely on them).
enum class ExitCode : int {
  kOk = 0,
  kInternal = 1,
  kUsage = 2,
  kScene = 3,
  kGraphics = 4,
  kNetwork = 5,
  kComparison = 6,
};

// X(enumerator, "stable-id", exit code, WebSocket close code)
#define MIRAGE_ERRORS(X)                                 \
  X(kInternal, "internal", kInternal, 1011)              \
  X(kUsage, "usage", kUsage, 1008)                       \
  X(kIo, "io", kInternal, 1011)                          \
  X(kSceneMissing, "scene-missing", kScene, 1011)        \
  X(kSceneFormat, "scene-format", kScene, 1011)          \
  X(kSceneRange, "scene-range", kScene, 1011)            \
  X(kSceneReference, "scene-reference", kScene, 1011)    \
  X(kSceneCycle, "scene-cycle", kScene, 1011)            \
  X(kSceneLimit, "scene-limit", kScene, 1011)            \
  X(kSceneUri, "scene-uri", kScene, 1011)                \
  X(kSceneExtension, "scene-extension", kScene, 1011)    \
  X(kSceneEmpty, "scene-empty", kScene, 1011)            \
  X(kSceneBuiltin, "scene-builtin", kScene, 1011)        \
  X(kGraphicsDevice, "graphics-device", kGraphics, 1011) \
  X(kGraphicsShader, "graphics-shader", kGraphics, 1011) \
  X(kGraphicsGl, "graphics-gl", kGraphics, 1011)         \
  X(kNetworkListen, "network-listen", kNetwork, 1011)    \
  X(kNetworkConnect, "network-connect", kNetwork, 1011)  \
  X(kNetworkClosed, "network-closed", kNetwork, 1011)    \
  X(kNetworkTimeout, "network-timeout", kNetwork, 1011)  \
  X(kWireMalformed, "wire-malformed", kNetwork, 1002)    \
  X(kWireVersion, "wire-version", kNetwork, 4001)        \
  X(kWireLimit, "wire-limit", kNetwork, 1009)            \
  X(kWireValue, "wire-value", kNetwork, 1008)            \
  X(kWireState, "wire-state", kNetwork, 1002)            \
  X(kCodec, "codec", kNetwork, 1007)                     \
  X(kAuth, "auth", kNetwork, 4003)                       \
  X(kBusy, "busy", kNetwork, 4013)                       \
  X(kComparison, "comparison", kComparison, 1011)

enum class ErrorId {
#define MIRAGE_X(e, id, exit, close) e,
  MIRAGE_ERRORS(MIRAGE_X)
#undef MIRAGE_X
};

/// The stable text id, as printed in `error <id>: <text>`.
std::string_view error_name(ErrorId id);
ExitCode exit_code(ErrorId id);
/// WebSocket close code (RFC 6455 §7.4; 4000+ are ours: libwebsockets 4.1 reports 1013 as 1002).
int close_code(ErrorId id);

struct Error {
  ErrorId id = ErrorId::kInternal;
  std::string text;
  std::string hint = {};

  /// `error <id>: <text>` and, where there is one, ` (hint: …)`; always a single line.
  std::string line() const;
};

inline Error make_error(ErrorId id, std::string text, std::string hint = {}) {
  return Error{id, std::move(text), std::move(hint)};
}

}  // namespace mirage
