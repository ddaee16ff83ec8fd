#pragma once
// The parts of a mirage_client, and how a call at the border of the library becomes one inside.

#include <mirage/client.h>
#include <mirage/frame.h>
#include <mirage/stats.h>

#include <array>
#include <cstring>
#include <functional>
#include <memory>
#include <new>
#include <optional>
#include <string>
#include <thread>
#include <vector>

#include "client/door/client.h"
#include "client/draw/composite.h"
#include "client/frame/reference_frame.h"
#include "client/library/context_mark.h"
#include "client/library/switch_link.h"
#include "protocol/base/result.h"
#include "protocol/impostor/camera.h"
#include "protocol/model/scene_types.h"

namespace mirage::library {

/// Where the scene stands in the host's world, in doubles.
struct Placement {
  glm::dquat rotation{1, 0, 0, 0};
  glm::dvec3 translation{0};
  double scale = 1;

  glm::dvec3 to_world(const glm::dvec3& p) const { return rotation * (scale * p) + translation; }
  glm::dvec3 to_scene(const glm::dvec3& p) const {
    return (glm::conjugate(rotation) * (p - translation)) / scale;
  }
};

/// A view of the frame that was planned last.
struct PlannedView {
  Camera camera;
  HostDepth depth;
};

/// The last failure; its texts stay where they are until the next one.
struct Failure {
  mirage_result result = MIRAGE_OK;
  std::string id, text, hint;
};

/// Returns the first bytes of a struct of the host's, the rest zero; `size` is its first member.
template <typename T>
T read_struct(const T& given) {
  T out{};
  std::memcpy(&out, &given, std::min<std::size_t>(given.size, sizeof(T)));
  return out;
}

/// Fills as much of a struct of the host's as it has room for, and keeps its `size`.
template <typename T>
void write_struct(T& to, T value) {
  value.size = to.size;
  std::memcpy(&to, &value, std::min<std::size_t>(to.size, sizeof(T)));
}

}  // namespace mirage::library

struct mirage_client {
  mirage_client_desc desc{};
  std::string name, ca_file;
  mirage::library::SwitchLink link;
  mirage::Client client;
  std::string token;
  mirage::SceneChoice choice;
  double usual_frame_ms = 0;                   ///< budget of a frame unless options say otherwise
  std::optional<mirage::Composite> composite;  ///< while attached
  std::optional<mirage::library::ContextMark> context;  ///< the same: that of attach
  std::thread::id gl_thread;                            ///< of attach
  bool open = false;                                    ///< client has a session
  bool broken = false;  ///< a call ended halfway: the session begins anew with the next update
  mirage_options options{};
  std::optional<mirage::Lighting> lighting;
  mirage::library::Placement placement;
  std::vector<mirage::library::PlannedView> planned;  ///< empty: nothing is
  std::int64_t now_us = 0;
  // Told by mirage_update() so far.
  std::uint64_t told_revision = 0;
  bool told_complete = false, told_up = false, told_drawable = false;
  std::string told_problem;
  std::uint64_t told_bytes = 0;
  std::optional<mirage::ReferenceFrame> reference;
  mutable std::string scene_name;
  mutable mirage::library::Failure failure;
};

namespace mirage::library {

/// Notes a failure, and returns its result.
mirage_result fail(const mirage_client& client, mirage_result result, const Error& error);
mirage_result fail(const mirage_client& client, const Error& error);
/// Fails with the caller's mistake.
mirage_result bad_argument(const mirage_client& client, const std::string& what);
mirage_result wrong_state(const mirage_client& client, const std::string& what);

/// Fails because the context of mirage_gl_attach() is not current.
mirage_result no_context(const mirage_client& client);

/// Notes that a call ended halfway, without memory for a text. Its session is not trusted any more.
mirage_result ended_halfway(mirage_client& client, mirage_result result) noexcept;
mirage_result ended_halfway(const mirage_client& client, mirage_result result) noexcept;

/// Runs a call; nothing is thrown out of it.
template <typename Client, typename Call>
mirage_result at_border(Client* client, const Call& call) noexcept {
  if (!client) return MIRAGE_BAD_ARGUMENT;
  try {
    return call();
  } catch (const std::bad_alloc&) {
    return ended_halfway(*client, MIRAGE_OUT_OF_MEMORY);
  } catch (...) {
    return ended_halfway(*client, MIRAGE_INTERNAL);
  }
}

/// As at_border(), for a call with GL: only on the thread of attach.
template <typename Call>
mirage_result on_gl_thread(mirage_client* client, const Call& call) noexcept {
  return at_border(client, [&]() -> mirage_result {
    if (!client->composite) return wrong_state(*client, "mirage_gl_attach() comes first");
    if (client->gl_thread != std::this_thread::get_id()) {
      return fail(*client, MIRAGE_WRONG_THREAD,
                  make_error(ErrorId::kInternal, "called on another thread than mirage_gl_attach()",
                             "one client, one thread; detach and attach to change it"));
    }
    if (!client->context->here()) return no_context(*client);
    return call();
  });
}

/// Says why a view of the planned frame cannot be drawn; nullopt: it can.
std::optional<mirage_result> not_planned(const mirage_client& client, std::int32_t view);

/// True if all are finite and none is beyond 1e30, which no scene needs.
bool all_finite(const double* values, std::size_t count);
/// Reads a quaternion x, y, z, w; all 0: none. nullopt: it is no rotation.
std::optional<glm::dquat> read_rotation(const double (&xyzw)[4]);
/// Reads a view into a camera of the scene. nullopt: MIRAGE_BAD_ARGUMENT, and `problem` says why.
std::optional<PlannedView> read_view(const mirage_client& client, const mirage_view& view,
                                     std::string& problem);

}  // namespace mirage::library
