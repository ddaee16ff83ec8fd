#include "protocol/wire/message_check.h"

#include <cmath>
#include <string>

#include "protocol/base/limits.h"
#include "protocol/impostor/light_probe.h"
#include "protocol/impostor/view_cell.h"
#include "protocol/model/scene_types.h"

namespace mirage {
namespace {

Error limit_error(const char* what) {
  return make_error(ErrorId::kWireLimit, std::string("too many ") + what);
}
Error value_error(const char* what) {
  return make_error(ErrorId::kWireValue, std::string(what) + " is missing, out of range or NaN");
}

template <typename T>
std::size_t count(const flatbuffers::Vector<T>* v) {
  return v ? v->size() : 0;
}
// FlatBuffers' verifier checks the offset of a vector of structs, but not where the first struct
// lies. Structs with 8-byte members must be aligned to 8.
template <typename T>
bool misaligned(const flatbuffers::Vector<const T*>* v) {
  return v && reinterpret_cast<std::uintptr_t>(v->Data()) % alignof(T) != 0;
}
Error alignment_error() {
  return make_error(ErrorId::kWireMalformed, "records that are not aligned");
}
bool long_text(const flatbuffers::String* s) { return s && s->size() > limits::kMaxTextBytes; }

bool finite(const wire::Vec3f* v) {
  return v && std::isfinite(v->x()) && std::isfinite(v->y()) && std::isfinite(v->z());
}
bool finite(const wire::Vec3d* v) {
  return v && std::isfinite(v->x()) && std::isfinite(v->y()) && std::isfinite(v->z());
}
bool unit(const wire::Quat* q) {
  if (!q) return false;
  const double n = std::sqrt(double(q->w()) * q->w() + double(q->x()) * q->x() +
                             double(q->y()) * q->y() + double(q->z()) * q->z());
  return std::abs(n - 1.0) < 1e-3;
}

bool view_size(std::uint32_t width, std::uint32_t height) {
  const auto edge = [](std::uint32_t v) {
    return v >= limits::kMinViewEdge && v <= limits::kMaxViewEdge && v % 2 == 0;
  };
  return edge(width) && edge(height) && std::size_t{width} * height <= limits::kMaxViewTexels;
}

bool field_of_view(double fov_y) {
  const double degrees = fov_y * 57.29577951308232;
  return degrees >= limits::kMinFovDegrees && degrees <= limits::kMaxFovDegrees;
}

Result<void> check(const wire::ViewRequest& m) {
  if (!view_size(m.width(), m.height())) return value_error("size of a view");
  if (!finite(m.eye()) || !unit(m.rotation())) return value_error("pose of a view");
  if (!field_of_view(m.fov_y())) return value_error("field of view");
  if (!std::isfinite(m.time_s())) return value_error("animation time");
  return {};
}

Result<void> check(const wire::ViewReply& m) {
  if (!view_size(m.width(), m.height())) return value_error("size of a view");
  if (!finite(m.eye()) || !unit(m.rotation()) || !field_of_view(m.fov_y())) {
    return value_error("pose of a view");
  }
  if (!(m.near_m() > 0) || !(m.far_m() >= m.near_m()) || !std::isfinite(m.far_m())) {
    return value_error("depth of a view");
  }
  if (!std::isfinite(m.time_s())) return value_error("animation time");
  if (count(m.instances()) > limits::kMaxViewInstances) return limit_error("instances in a view");
  return {};
}

bool long_choice(const flatbuffers::String* s) { return s && s->size() > limits::kMaxChoiceBytes; }

using Texts = flatbuffers::Vector<flatbuffers::Offset<flatbuffers::String>>;
bool too_many_choices(const Texts* names) {
  if (count(names) > limits::kMaxChoices) return true;
  for (flatbuffers::uoffset_t i = 0; i < count(names); ++i) {
    if (long_choice(names->Get(i))) return true;
  }
  return false;
}

Result<void> check(const wire::Hello& m) {
  if (m.view()) {
    if (Result<void> view = check(*m.view()); !view) return view;
  }
  if (long_text(m.token()) || long_text(m.name())) return limit_error("characters in a text");
  if (long_choice(m.clip()) || long_choice(m.variant())) return limit_error("bytes in a choice");
  if (count(m.codecs()) > limits::kMaxCodecs) return limit_error("codecs");
  return {};
}

Result<void> check_lighting(const wire::Lighting* lighting) {
  if (!lighting || !finite(lighting->ambient())) return value_error("lighting");
  if (count(lighting->lights()) > limits::kMaxLights) return limit_error("lights");
  if (misaligned(lighting->lights())) return alignment_error();
  if (const wire::ProbeLight* probe = lighting->probe()) {
    const bool strength = std::isfinite(probe->strength()) && probe->strength() >= 0;
    if (!unit(&probe->rotation()) || !strength) return value_error("light probe");
  }
  return {};
}

Result<void> check(const wire::LightProbePage& m) {
  if (m.id() == 0 || count(m.irradiance()) != 3 * kProbeTerms) return value_error("light probe");
  for (const float v : *m.irradiance()) {
    if (!std::isfinite(v)) return value_error("light probe");
  }
  return {};
}

Result<void> check_look(const wire::Welcome& m) {
  if (m.tone() > static_cast<std::uint8_t>(ToneCurve::kNeutral)) return value_error("tone curve");
  if (count(m.home_fit()) > limits::kMaxFitPoints) return limit_error("points of the home view");
  if (misaligned(m.home_fit())) return alignment_error();
  for (std::size_t i = 0; i < count(m.home_fit()); ++i) {
    if (!finite(m.home_fit()->Get(static_cast<flatbuffers::uoffset_t>(i)))) {
      return value_error("points of the home view");
    }
  }
  const wire::StudioFloor* const floor = m.floor();
  if (!floor) return {};
  const bool good = finite(floor->center()) && finite(floor->color()) &&
                    std::isfinite(floor->half()) && floor->half() > 0 &&
                    count(floor->shadow()) == std::size_t{StudioFloor::kEdge} * StudioFloor::kEdge;
  return good ? Result<void>() : value_error("floor");
}

Result<void> check(const wire::Welcome& m) {
  if (long_text(m.scene()) || long_text(m.renderer())) return limit_error("characters in a text");
  if (too_many_choices(m.clips()) || too_many_choices(m.variants())) return limit_error("choices");
  if (long_choice(m.clip()) || long_choice(m.variant())) return limit_error("bytes in a choice");
  if (m.objects() > limits::kMaxObjects) return limit_error("objects");
  if (m.instances() > limits::kMaxInstances) return limit_error("instances");
  if (m.groups() > limits::kMaxInstances) return limit_error("groups");
  if (m.roots() > m.instances() + m.groups()) return value_error("roots");
  if (!finite(m.bounds_center()) || !std::isfinite(m.bounds_radius()) || m.bounds_radius() < 0) {
    return value_error("bounds of the scene");
  }
  if (m.images() > limits::kMaxImages) return limit_error("images");
  if (count(m.codecs()) > limits::kMaxCodecs) return limit_error("codecs");
  const bool home = finite(m.home_eye()) && finite(m.home_target()) &&
                    std::isfinite(m.walk_radius_m()) && std::isfinite(m.walk_speed_mps()) &&
                    m.walk_radius_m() > 0 && std::isfinite(m.walk_eye_m()) && m.walk_eye_m() >= 0;
  const bool sky = finite(m.sky_zenith()) && finite(m.sky_horizon()) && finite(m.sky_nadir());
  const bool fog = std::isfinite(m.fog_density()) && m.fog_density() >= 0;
  if (!home || !sky || !fog) return value_error("home view or environment");
  if (Result<void> look = check_look(m); !look) return look;
  return check_lighting(m.lighting());
}

Result<void> check(const wire::ImagePage& m) {
  if (count(m.images()) > limits::kImagesPerPage) return limit_error("images in a page");
  for (std::size_t i = 0; i < count(m.images()); ++i) {
    const wire::ImageInfo* image = m.images()->Get(static_cast<flatbuffers::uoffset_t>(i));
    const bool good = image->width() >= 1 && image->height() >= 1 &&
                      image->width() <= limits::kMaxImageEdge &&
                      image->height() <= limits::kMaxImageEdge &&
                      std::isfinite(image->alpha_cutoff()) && image->alpha_cutoff() >= 0;
    if (!good) return value_error("image");
  }
  return {};
}

Result<void> check_lods(const flatbuffers::Vector<const wire::LodInfo*>* lods) {
  if (count(lods) > limits::kMaxLods) return limit_error("levels of detail");
  for (std::size_t i = 0; i < count(lods); ++i) {
    const wire::LodInfo* lod = lods->Get(static_cast<flatbuffers::uoffset_t>(i));
    const bool good = std::isfinite(lod->error()) && lod->error() >= 0 &&
                      std::isfinite(lod->spread()) && lod->spread() >= 0 &&
                      std::isfinite(lod->shading()) && lod->shading() >= 0;
    if (!good) return value_error("level of detail");
  }
  return {};
}

bool moderate(const flatbuffers::Vector<float>* list) {
  for (std::size_t i = 0; i < count(list); ++i) {
    const float v = list->Get(static_cast<flatbuffers::uoffset_t>(i));
    if (!(v >= 0) || !std::isfinite(v)) return false;
  }
  return true;
}

bool finite(const flatbuffers::Vector<const wire::Vec3f*>* list) {
  for (std::size_t i = 0; i < count(list); ++i) {
    if (!finite(list->Get(static_cast<flatbuffers::uoffset_t>(i)))) return false;
  }
  return true;
}

Result<void> check_motion(const wire::ObjectInfo& o) {
  const bool moves = o.clip_s() > 0;
  const std::size_t segments = moves ? limits::kMotionSegments : 0;
  const std::size_t jumps = moves ? std::size_t{1} << limits::kMaxPhaseLevel : 0;
  const bool counts = count(o.speed()) == segments &&
                      (count(o.jump()) == jumps || count(o.jump()) == 0) &&
                      (count(o.hidden()) == jumps / 8 || count(o.hidden()) == 0);
  const bool clip = o.clip_s() >= 0 && o.clip_s() <= limits::kMaxClipSeconds;
  const bool wrap = o.wrap_jump() >= 0 && std::isfinite(o.wrap_jump());
  if (!counts || !clip || !wrap || !moderate(o.speed()) || !moderate(o.jump())) {
    return value_error("motion of an object");
  }
  const float track_s = o.track_clip_s();
  const std::size_t places = track_s > 0 ? limits::kTrackSteps + 1 : 0;
  const bool timed = track_s >= 0 && track_s <= limits::kMaxClipSeconds;
  if (!timed || count(o.track()) != places || !finite(o.track())) {
    return value_error("way of an object");
  }
  return {};
}

Result<void> check(const wire::ObjectPage& m) {
  if (count(m.objects()) > limits::kObjectsPerPage) return limit_error("objects in a page");
  if (!m.objects()) return {};
  for (const wire::ObjectInfo* o : *m.objects()) {
    const bool sizes = finite(o->center()) && finite(o->box_min()) && finite(o->box_max()) &&
                       finite(o->mean_color()) && std::isfinite(o->radius()) && o->radius() >= 0;
    if (!sizes) return value_error("object bounds");
    const bool everywhere = o->faces_sine() == 1;
    const bool one_sided =
        o->faces_axis() && finite(o->faces_axis()) && o->faces_sine() >= 0 && o->faces_sine() < 1;
    if (!everywhere && !one_sided) return value_error("faces of an object");
    if (o->name() && o->name()->size() > limits::kMaxObjectNameBytes) {
      return limit_error("characters in an object's name");
    }
    if (!(o->opacity() >= 0 && o->opacity() <= 1)) return value_error("opacity of an object");
    if (Result<void> motion = check_motion(*o); !motion) return motion;
    if (count(o->hull_vertices()) > limits::kMaxHullVertices ||
        count(o->hull_indices()) > limits::kMaxHullTriangles * 3 ||
        count(o->hull_indices()) % 3 != 0 ||
        count(o->hull_parallax()) != count(o->hull_vertices())) {
      return limit_error("hull vertices");
    }
    if (Result<void> lods = check_lods(o->lods()); !lods) return lods;
    for (std::size_t i = 0; i < count(o->hull_parallax()); ++i) {
      const float factor = o->hull_parallax()->Get(static_cast<flatbuffers::uoffset_t>(i));
      if (!std::isfinite(factor) || factor < 0) return value_error("hull parallax");
    }
    for (std::size_t i = 0; i < count(o->hull_vertices()); ++i) {
      if (!finite(o->hull_vertices()->Get(static_cast<flatbuffers::uoffset_t>(i)))) {
        return value_error("hull vertex");
      }
    }
    for (std::size_t i = 0; i < count(o->hull_indices()); ++i) {
      if (o->hull_indices()->Get(static_cast<flatbuffers::uoffset_t>(i)) >=
          count(o->hull_vertices())) {
        return value_error("hull index");
      }
    }
  }
  return {};
}

Result<void> check(const wire::InstancePage& m) {
  if (count(m.instances()) > limits::kInstancesPerPage ||
      count(m.groups()) > limits::kInstancesPerPage ||
      count(m.opened()) > limits::kInstancesPerPage) {
    return limit_error("instances in a page");
  }
  if (misaligned(m.instances()) || misaligned(m.groups())) return alignment_error();
  for (std::size_t k = 0; k < count(m.instances()); ++k) {
    const wire::InstanceRecord* i = m.instances()->Get(static_cast<flatbuffers::uoffset_t>(k));
    const bool scale = std::isfinite(i->scale()) && i->scale() > 0;
    if (!finite(&i->position()) || !unit(&i->rotation()) || !scale ||
        !std::isfinite(i->clip_offset_s()) ||
        i->importance() > static_cast<std::uint8_t>(Importance::kImportant))
      return value_error("instance");
  }
  for (std::size_t k = 0; k < count(m.groups()); ++k) {
    const wire::GroupRecord* g = m.groups()->Get(static_cast<flatbuffers::uoffset_t>(k));
    const wire::Vec3f& half = g->half();
    const bool extent = finite(&half) && half.x() >= 0 && half.y() >= 0 && half.z() >= 0;
    if (!finite(&g->center()) || !extent ||
        g->importance() > static_cast<std::uint8_t>(Importance::kImportant)) {
      return value_error("group");
    }
  }
  return {};
}

Result<void> check(const wire::OpenRequest& m) {
  if (count(m.groups()) > limits::kMaxOpensPerRequest) return limit_error("groups in a request");
  const auto within = [](double v, double low, double high) { return v >= low && v <= high; };
  const bool rule = within(m.focal_px(), 1e-3, 1e9) && within(m.tau_px(), 1e-6, 1e6) &&
                    within(m.speed_mps(), 0, 1e9) && within(m.margin(), 1, 16);
  if (!finite(m.eye()) || !finite(m.forward()) || !rule) return value_error("viewer of a request");
  return {};
}

Result<void> check(const wire::SetLighting& m) { return check_lighting(m.lighting()); }

Result<void> check(const wire::RequestBatch& m) {
  if (count(m.asks()) > limits::kMaxAsksPerBatch) return limit_error("asks in a batch");
  if (count(m.cancels()) > limits::kMaxCancelsPerBatch) return limit_error("cancels in a batch");
  if (count(m.mesh_asks()) > limits::kMaxAsksPerBatch ||
      count(m.image_asks()) > limits::kMaxAsksPerBatch) {
    return limit_error("asks in a batch");
  }
  for (std::size_t i = 0; i < count(m.asks()); ++i) {
    const wire::Ask* ask = m.asks()->Get(static_cast<flatbuffers::uoffset_t>(i));
    if (!std::isfinite(ask->error_px())) return value_error("ask");
  }
  return {};
}

Result<void> check(const wire::TileReply& m) {
  if (!(m.color_rms() >= 0) || m.color_rms() > 255) return value_error("colour error");
  return {};
}

Result<void> check(const wire::ReferenceRequest& m) {
  const bool size = m.width() >= 1 && m.height() >= 1 && m.width() <= limits::kMaxReferenceEdge &&
                    m.height() <= limits::kMaxReferenceEdge && m.supersample() >= 1 &&
                    m.supersample() <= limits::kMaxReferenceSupersample;
  if (!size || !finite(m.eye()) || !unit(m.rotation())) return value_error("reference camera");
  if (!field_of_view(m.fov_y())) return value_error("field of view");
  const auto near = [](double shift, std::uint32_t edge) { return std::abs(shift) <= 8.0 * edge; };
  const bool shifted = near(m.shift_x(), m.width()) && near(m.shift_y(), m.height());
  if (!shifted) return value_error("shift of a picture");
  if (!(m.pixel_aspect() >= 1e-2 && m.pixel_aspect() <= 1e2))
    return value_error("shape of a pixel");
  if (!std::isfinite(m.time_s())) return value_error("animation time");
  return {};
}

Result<void> check(const wire::Catalogue& m) {
  if (count(m.tiles()) > limits::kFrozenPerPage || count(m.assets()) > limits::kFrozenPerPage) {
    return limit_error("files in a page");
  }
  if (misaligned(m.tiles()) || misaligned(m.assets())) return alignment_error();
  return {};
}

Result<void> check(const wire::Bye& m) {
  if (long_text(m.error()) || long_text(m.text())) return limit_error("characters in a text");
  return {};
}

}  // namespace

Result<void> check_body(const wire::Control& control) {
  // The verifier accepts a body whose tag is set and whose table is absent.
  if (!control.body()) return make_error(ErrorId::kWireMalformed, "message has no body");
  switch (control.body_type()) {
    case wire::Body::Hello:
      return check(*control.body_as_Hello());
    case wire::Body::Welcome:
      return check(*control.body_as_Welcome());
    case wire::Body::LightProbePage:
      return check(*control.body_as_LightProbePage());
    case wire::Body::ImagePage:
      return check(*control.body_as_ImagePage());
    case wire::Body::ObjectPage:
      return check(*control.body_as_ObjectPage());
    case wire::Body::InstancePage:
      return check(*control.body_as_InstancePage());
    case wire::Body::SetLighting:
      return check(*control.body_as_SetLighting());
    case wire::Body::RequestBatch:
      return check(*control.body_as_RequestBatch());
    case wire::Body::OpenRequest:
      return check(*control.body_as_OpenRequest());
    case wire::Body::ReferenceRequest:
      return check(*control.body_as_ReferenceRequest());
    case wire::Body::ViewRequest:
      return check(*control.body_as_ViewRequest());
    case wire::Body::ViewReply:
      return check(*control.body_as_ViewReply());
    case wire::Body::TileReply:
      return check(*control.body_as_TileReply());
    case wire::Body::Catalogue:
      return check(*control.body_as_Catalogue());
    case wire::Body::Bye:
      return check(*control.body_as_Bye());
    case wire::Body::StatsRequest:
    case wire::Body::Refused:
    case wire::Body::MeshReply:
    case wire::Body::ImageReply:
    case wire::Body::ReferenceReply:
    case wire::Body::Stats:
    case wire::Body::GroundRequest:
    case wire::Body::GroundReply:
      if (control.body() == nullptr) break;
      return {};
    default:
      break;  // NONE, or a union tag this version does not know
  }
  return make_error(ErrorId::kWireMalformed, "message has no known body");
}

}  // namespace mirage
