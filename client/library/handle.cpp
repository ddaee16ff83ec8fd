#include "client/library/handle.h"

#include <cmath>
#include <utility>

namespace mirage::library {
namespace {

constexpr double kMost = 1e30;
constexpr std::int32_t kMostPixels = 16384;
constexpr double kWidestTangent = 1e3;

mirage_result result_of(ErrorId id) {
  switch (id) {
    case ErrorId::kUsage:
      return MIRAGE_BAD_ARGUMENT;
    case ErrorId::kAuth:
    case ErrorId::kComparison:
      return MIRAGE_REFUSED;
    case ErrorId::kResources:
      return MIRAGE_OUT_OF_MEMORY;
    default:
      break;
  }
  switch (exit_code(id)) {
    case ExitCode::kGraphics:
      return MIRAGE_GRAPHICS;
    case ExitCode::kNetwork:
      return MIRAGE_NETWORK;
    default:
      return MIRAGE_INTERNAL;
  }
}

HostDepth depth_of(const mirage_view& view) {
  const double n = view.near_m, f = view.far_m;
  HostDepth depth;
  depth.reversed = view.depth == MIRAGE_DEPTH_REVERSED;
  if (view.depth == MIRAGE_DEPTH_LOGARITHMIC) {
    depth.log_factor = 1 / std::log2(1 + f);
  } else if (depth.reversed) {
    depth.window = f > 0 ? glm::dvec2(-n, f * n) / (f - n) : glm::dvec2(0, n);
  } else {
    depth.window = f > 0 ? glm::dvec2(f, -f * n) / (f - n) : glm::dvec2(1, -n);
  }
  return depth;
}

/// Says what is wrong with the numbers of a view; empty: nothing.
std::string problem_of(const mirage_view& view) {
  const double tangents[] = {view.tan_left, view.tan_right, view.tan_down, view.tan_up};
  if (!all_finite(view.eye, 3)) return "eye is not finite, or beyond 1e30";
  for (const double tangent : tangents) {
    if (!(std::abs(tangent) <= kWidestTangent)) return "a tangent is beyond 1000, or not finite";
  }
  if (!(view.tan_left < view.tan_right && view.tan_down < view.tan_up)) {
    return "tan_left must be below tan_right, and tan_down below tan_up: mirrored and orthographic "
           "cameras cannot be said";
  }
  if (view.width < 1 || view.height < 1 || view.width > kMostPixels || view.height > kMostPixels) {
    return "width and height are 1 to 16384";
  }
  if (view.depth < MIRAGE_DEPTH_FORWARD || view.depth > MIRAGE_DEPTH_LOGARITHMIC) {
    return "depth is none of MIRAGE_DEPTH_";
  }
  const double planes[] = {view.near_m, view.far_m};
  const bool logarithmic = view.depth == MIRAGE_DEPTH_LOGARITHMIC;
  const bool ordered = logarithmic
                           ? view.far_m > 0
                           : view.near_m > 0 && (view.far_m == 0 || view.far_m > view.near_m);
  if (!all_finite(planes, 2) || !ordered) {
    return "near_m must be above 0 and below far_m; far_m 0 is without a far plane, except for "
           "logarithmic depth";
  }
  return {};
}

}  // namespace

mirage_result fail(const mirage_client& client, mirage_result result, const Error& error) {
  client.failure = {result, std::string(error_name(error.id)), error.text, error.hint};
  return result;
}

mirage_result fail(const mirage_client& client, const Error& error) {
  return fail(client, result_of(error.id), error);
}

mirage_result ended_halfway(const mirage_client& client, mirage_result result) noexcept {
  client.failure.result = result;
  client.failure.id.clear();
  client.failure.text.clear();
  client.failure.hint.clear();
  return result;
}

mirage_result ended_halfway(mirage_client& client, mirage_result result) noexcept {
  client.planned.clear();
  client.broken = client.broken || client.open;
  client.open = false;
  return ended_halfway(std::as_const(client), result);
}

mirage_result bad_argument(const mirage_client& client, const std::string& what) {
  return fail(client, MIRAGE_BAD_ARGUMENT, make_error(ErrorId::kUsage, what));
}

mirage_result wrong_state(const mirage_client& client, const std::string& what) {
  return fail(client, MIRAGE_WRONG_STATE, make_error(ErrorId::kUsage, what));
}

std::optional<mirage_result> not_planned(const mirage_client& client, std::int32_t view) {
  if (client.planned.empty()) return wrong_state(client, "mirage_plan() comes first");
  const auto views = static_cast<std::int32_t>(client.planned.size());
  if (view < 0 || view >= views) {
    return bad_argument(client, "view is " + std::to_string(view) +
                                    ", and mirage_plan() was told " + std::to_string(views) +
                                    ", the first of them 0");
  }
  return std::nullopt;
}

mirage_result no_context(const mirage_client& client) {
  const bool other = any_context();
  return fail(
      client, MIRAGE_GRAPHICS,
      make_error(ErrorId::kGraphicsDevice,
                 other ? "another GL context is current than at mirage_gl_attach()"
                       : "no GL context is current",
                 "make it current on this thread; after a loss, mirage_gl_detach(client, 1)"));
}

bool all_finite(const double* values, std::size_t count) {
  for (std::size_t i = 0; i < count; ++i) {
    if (!(std::abs(values[i]) <= kMost)) return false;
  }
  return true;
}

std::optional<glm::dquat> read_rotation(const double (&xyzw)[4]) {
  constexpr double kTolerance = 1e-3;
  const glm::dquat q(xyzw[3], xyzw[0], xyzw[1], xyzw[2]);
  const double length = glm::length(q);
  if (length == 0) return glm::dquat(1, 0, 0, 0);
  if (!(std::abs(length - 1) < kTolerance)) return std::nullopt;
  return glm::normalize(q);
}

std::optional<PlannedView> read_view(const mirage_client& client, const mirage_view& view,
                                     std::string& problem) {
  problem = problem_of(view);
  if (view.size < sizeof(mirage_view)) problem = "size of the view is below sizeof(mirage_view)";
  const std::optional<glm::dquat> rotation = read_rotation(view.rotation);
  if (!rotation) problem = "rotation is no unit quaternion";
  if (!problem.empty()) return std::nullopt;
  const Placement& at = client.placement;
  PlannedView out;
  out.camera.pose.eye = at.to_scene(glm::dvec3(view.eye[0], view.eye[1], view.eye[2]));
  out.camera.pose.rotation = glm::quat(glm::conjugate(at.rotation) * *rotation);
  out.camera.width = static_cast<std::uint32_t>(view.width);
  out.camera.height = static_cast<std::uint32_t>(view.height);
  if (!set_tangents(out.camera, {view.tan_left, view.tan_right, view.tan_down, view.tan_up})) {
    problem = "the tangents enclose nothing";
    return std::nullopt;
  }
  out.depth = depth_of(view);
  return out;
}

}  // namespace mirage::library
