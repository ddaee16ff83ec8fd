#pragma once
// Errors as an enumerated list. One table maps an id to its exit code, its
// WebSocket close code, its cause and its cure. Tests assert ids, never texts.

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

// docs/guide/troubleshooting.md and docs/reference/errors.md are written from this table.
// X(enumerator, "stable-id", exit code, WebSocket close code, "cause", "cure")
#define MIRAGE_ERRORS(X)                                                                           \
  X(kInternal, "internal", kInternal, 1011, "The program met a state that it should never meet.",  \
    "Repeat it with the newest build. If it comes again, report it with the command and the "      \
    "whole line.")                                                                                 \
  X(kResources, "resources", kGraphics, 1011,                                                      \
    "The machine, or a limit of it, gives this program too few threads or too little memory.",     \
    "Raise the limit that the line names: ulimit -u and -v, or a container's --pids-limit and "    \
    "--memory.")                                                                                   \
  X(kUsage, "usage", kUsage, 1008,                                                                 \
    "An option, a line of the configuration file, a MIRAGE_… variable or a file that an option " \
    "names is wrong.",                                                                             \
    "Correct what the line names. The program's --help lists its options; --check-config checks "  \
    "a server's.")                                                                                 \
  X(kIo, "io", kInternal, 1011,                                                                    \
    "A file of yours could not be read or written, or a helper program such as gnuplot is "        \
    "missing.",                                                                                    \
    "Check the path, the permissions and the free space of the disk.")                             \
  X(kModule, "module", kInternal, 1011,                                                            \
    "A library that Mirage loads at first need is missing, does not load or is of another build: " \
    "libmirage_images for images, libmirage_video for the report's video.",                        \
    "Keep the modules where the installation or the bundle put them. If one does not load, "       \
    "install the library that the line names.")                                                    \
  X(kSceneMissing, "scene-missing", kScene, 1011,                                                  \
    "The scene file, or a file that it needs to be drawn, does not exist or cannot be read.",      \
    "Check the spelling and the permissions. Keep a .gltf together with its .bin and images.")     \
  X(kSceneFormat, "scene-format", kScene, 1011,                                                    \
    "The file is not glTF 2.0, or a part of it is damaged: JSON, GLB chunks, images or "           \
    "compressed geometry.",                                                                        \
    "Open the file in the Khronos glTF validator, then export it again.")                          \
  X(kSceneRange, "scene-range", kScene, 1011,                                                      \
    "A number in the scene is impossible: an offset behind the end of its buffer, an index "       \
    "behind the last vertex, NaN or infinity.",                                                    \
    "Export the file again. The line names the accessor, node or material.")                       \
  X(kSceneReference, "scene-reference", kScene, 1011,                                              \
    "The scene refers to a mesh, accessor, buffer or node that it does not contain.",              \
    "Export the file again. The line names the element and the missing index.")                    \
  X(kSceneCycle, "scene-cycle", kScene, 1011,                                                      \
    "The nodes of the scene do not form a tree: a node is its own ancestor or has two parents.",   \
    "Repair the node that the line names in a glTF editor.")                                       \
  X(kSceneLimit, "scene-limit", kScene, 1011,                                                      \
    "The scene is larger than the server takes: vertices, instances, pixels, file size or "        \
    "graphics memory.",                                                                            \
    "Simplify or split the scene, or raise the limit that the line names: --scene-mb or "          \
    "--gpu-mb.")                                                                                   \
  X(kSceneUri, "scene-uri", kScene, 1011,                                                          \
    "The scene names a file that the server must not open: outside its folder, on another host "   \
    "or not a regular file. Or the URI itself is broken: empty, with control characters, or "      \
    "data: without valid base64.",                                                                 \
    "Put the file beside the scene and refer to it by a relative path. Export the file again if "  \
    "it is a data: URI.")                                                                          \
  X(kSceneExtension, "scene-extension", kScene, 1011,                                              \
    "The scene requires a glTF extension that Mirage does not read.",                              \
    "Convert the file; the hint of the line names the command where there is one.")                \
  X(kSceneEmpty, "scene-empty", kScene, 1011, "The scene has nothing that can be drawn.",          \
    "Check that the default scene of the file has nodes with meshes.")                             \
  X(kSceneBuiltin, "scene-builtin", kScene, 1011,                                                  \
    "The name or an option of a built-in scene is wrong.",                                         \
    "mirage-server --help lists the built-in scenes with their options and ranges.")               \
  X(kGraphicsDevice, "graphics-device", kGraphics, 1011,                                           \
    "No usable EGL device or display was found, or the named one does not work.",                  \
    "Run mirage-server --list-devices and choose one with --device. A viewer without a display "   \
    "needs --offscreen WxH.")                                                                      \
  X(kGraphicsShader, "graphics-shader", kGraphics, 1011,                                           \
    "The graphics driver refused a shader of Mirage.",                                             \
    "Update the driver, or choose the software renderer with --device surfaceless.")               \
  X(kGraphicsGl, "graphics-gl", kGraphics, 1011,                                                   \
    "OpenGL reported an error, mostly because graphics memory ran out, or the device was reset.",  \
    "Lower --gpu-mb on a server, --atlas-mb and --mesh-mb on a viewer; look into the system log.") \
  X(kNetworkListen, "network-listen", kNetwork, 1011,                                              \
    "The server cannot listen on the address of --listen or --admin.",                             \
    "Stop the program that holds the port, choose another port, or use port 0.")                   \
  X(kNetworkConnect, "network-connect", kNetwork, 1011,                                            \
    "No Mirage server answers at the URL. Or only one of the two speaks TLS, or the server's "     \
    "certificate is not trusted here.",                                                            \
    "The message says which. Check that the server printed its ready line, the host and port of "  \
    "the URL, and firewalls. --tls-ca FILE trusts a certificate of your own.")                     \
  X(kNetworkClosed, "network-closed", kNetwork, 1011,                                              \
    "The other side ended the connection, for example because the server was stopped.",            \
    "Look into the server's log. A viewer connects again by itself.")                              \
  X(kNetworkTimeout, "network-timeout", kNetwork, 1011,                                            \
    "The other side is connected but did not answer in time.",                                     \
    "A loading server needs patience: raise --connect-timeout. Otherwise look into its log.")      \
  X(kWireMalformed, "wire-malformed", kNetwork, 1002,                                              \
    "Bytes arrived that are no message of Mirage's protocol.",                                     \
    "Check that the URL is a Mirage server's and that no proxy changes what passes.")              \
  X(kWireVersion, "wire-version", kNetwork, 4001,                                                  \
    "Viewer and server speak different versions of the protocol.",                                 \
    "Install the same version on both sides.")                                                     \
  X(kWireLimit, "wire-limit", kNetwork, 1009, "A message is larger than the protocol allows.",     \
    "Use the programs of one build on both sides; the limits are in protocol/base/limits.h.")      \
  X(kWireValue, "wire-value", kNetwork, 1008,                                                      \
    "A message has a value that is out of range, or answers what nobody asked for.",               \
    "Use the programs of one build on both sides; report it if it stays.")                         \
  X(kWireState, "wire-state", kNetwork, 1002,                                                      \
    "A message came at a moment when the protocol does not allow it.",                             \
    "Use the programs of one build on both sides; report it if it stays.")                         \
  X(kCodec, "codec", kNetwork, 1007,                                                               \
    "An image, tile or mesh could not be compressed or decompressed, or both sides have no codec " \
    "in common.",                                                                                  \
    "For tiles, use --codec auto on both sides. For the video part of the report, install "        \
    "libavcodec with x264.")                                                                       \
  X(kAuth, "auth", kNetwork, 4003,                                                                 \
    "The token is missing, wrong or expired, or lacks the right for this request.",                \
    "Give the token with --token-file, or #token=… in a browser. Make a new one with "           \
    "mirage-token.")                                                                               \
  X(kBusy, "busy", kNetwork, 4013,                                                                 \
    "The server has no room: too many clients, too many waiting requests, or no memory. It also "  \
    "says so while it shuts down, and to a client that does not read what it asked for.",          \
    "Viewers connect again by themselves. An operator raises --max-clients or adds servers, see "  \
    "docs/guide/scaling.md.")                                                                      \
  X(kComparison, "comparison", kComparison, 1011,                                                  \
    "A comparison failed: a tile differs from its hash, or a check of the report or test does "    \
    "not hold.",                                                                                   \
    "Read the lines before it: they name the case, the figure and its limit. Full renders need "   \
    "mirage-server --references.")

enum class ErrorId {
#define MIRAGE_X(e, id, exit, close, cause, cure) e,
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
