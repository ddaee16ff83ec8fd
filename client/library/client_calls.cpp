// Calls of mirage/client.h and mirage/error.h that make, connect and update a client.
#include <algorithm>
#include <cmath>

#include "client/draw/frame_renderer.h"
#include "client/library/gl_guard.h"
#include "client/library/handle.h"
#include "client/native/server_url.h"
#include "client/price/cost_model.h"
#include "client/scene/scene_view.h"
#include "client/screen/viewer_defaults.h"
#include "client/session/client_session.h"
#include "client/session/session_options.h"
#include "shaders/gl/dialect.h"
#include "shaders/gl/renderer.h"

using namespace mirage;           // NOLINT: the border between C and the library
using namespace mirage::library;  // NOLINT

namespace {

constexpr int kAtlasMb = 192, kGeometryMb = 256;
constexpr double kHardwareFrameMs = 16;

bool within(double value, double low, double high) { return value >= low && value <= high; }

std::string problem_of(const mirage_client_desc& desc) {
  if (desc.atlas_mb != 0 && !within(desc.atlas_mb, 1, 4096)) return "atlas_mb is 1 to 4096";
  if (desc.geometry_mb != 0 && !within(desc.geometry_mb, 1, 65536)) {
    return "geometry_mb is 1 to 65536";
  }
  if (desc.tau_px != 0 && !within(desc.tau_px, 0.01, 1000)) return "tau_px is 0.01 to 1000";
  if (desc.samples != 0 && !within(desc.samples, 1, 16)) return "samples is 1 to 16";
  return {};
}

ClientOptions session_options(const mirage_client& client) {
  const mirage_client_desc& desc = client.desc;
  ClientOptions out;
  out.name = client.name;
  out.token = client.token;
  out.choice = client.choice;
  out.frame_ms = client.options.frame_ms > 0 ? client.options.frame_ms : client.usual_frame_ms;
  if (desc.tau_px > 0) out.tau_px = desc.tau_px;
  if (desc.samples > 0) out.samples = desc.samples;
  const int geometry_mb = desc.geometry_mb > 0 ? desc.geometry_mb : kGeometryMb;
  out.mesh_budget_bytes = static_cast<std::size_t>(geometry_mb) << 20;
  return out;
}

void tell(const mirage_client& client, std::int32_t level, const Error& error) {
  if (client.desc.log) client.desc.log(client.desc.user, level, error.line().c_str());
}

/// Makes the session once there are a link and a context.
void open_session(mirage_client& client) {
  if (client.broken) {
    client.client.close();
    client.told_drawable = false;
    client.link.reconnect();
    client.broken = false;
  }
  if (client.open || !client.link.wanted()) return;
  const auto problem = [&client](const Error& error) {
    fail(client, error);
    tell(client, MIRAGE_LOG_ERROR, error);
  };
  client.client.open(client.link, session_options(client), problem);
  client.open = true;
  if (client.lighting) client.client.session().set_lighting(*client.lighting, client.now_us);
}

/// Says what was asked for in the address and is not offered; nullopt: nothing, or it is not known
/// yet.
std::optional<Error> missing_choice(const SceneView& scene, const SceneChoice& asked) {
  if (!scene.complete()) return std::nullopt;
  const auto missing = [](const std::string& name, const std::vector<std::string>& offered) {
    return !name.empty() && std::find(offered.begin(), offered.end(), name) == offered.end();
  };
  const bool clip = missing(asked.clip, scene.choices.clips);
  if (!clip && !missing(asked.variant, scene.choices.variants)) return std::nullopt;
  return make_error(ErrorId::kUsage, clip ? "the scene has no clip '" + asked.clip + "'"
                                          : "the scene has no variant '" + asked.variant + "'");
}

std::uint32_t events_of(mirage_client& client) {
  std::uint32_t events = 0;
  const ClientSession& session = client.client.session();
  const SceneView& scene = session.scene();
  const bool drawable = session.drawable(), complete = scene.complete(),
             up = client.link.connected();
  if (drawable && (!client.told_drawable || scene.revision != client.told_revision ||
                   complete != client.told_complete)) {
    events |= MIRAGE_EVENT_SCENE;
  }
  client.told_drawable = drawable;
  client.told_revision = scene.revision;
  client.told_complete = complete;
  if (up != client.told_up) events |= up ? MIRAGE_EVENT_UP : MIRAGE_EVENT_DOWN;
  client.told_up = up;
  const std::uint64_t bytes = client.link.traffic().bytes_down;
  if (bytes != client.told_bytes) events |= MIRAGE_EVENT_REDRAW;
  client.told_bytes = bytes;
  std::optional<Error> problem = client.link.problem();
  if (!problem) problem = missing_choice(scene, client.choice);
  const std::string line = problem ? problem->line() : "";
  if (problem && line != client.told_problem) {
    fail(client, *problem);
    tell(client, MIRAGE_LOG_WARNING, *problem);
    events |= MIRAGE_EVENT_PROBLEM;
  }
  client.told_problem = line;
  return events;
}

}  // namespace

int32_t mirage_version(void) { return MIRAGE_CLIENT_VERSION; }

const char* mirage_result_name(mirage_result result) {
  switch (result) {
    case MIRAGE_OK:
      return "ok";
    case MIRAGE_NOT_YET:
      return "not-yet";
    case MIRAGE_BAD_ARGUMENT:
      return "bad-argument";
    case MIRAGE_WRONG_STATE:
      return "wrong-state";
    case MIRAGE_WRONG_THREAD:
      return "wrong-thread";
    case MIRAGE_UNSUPPORTED:
      return "unsupported";
    case MIRAGE_OUT_OF_MEMORY:
      return "out-of-memory";
    case MIRAGE_GRAPHICS:
      return "graphics";
    case MIRAGE_NETWORK:
      return "network";
    case MIRAGE_REFUSED:
      return "refused";
    case MIRAGE_INTERNAL:
      return "internal";
    default:
      return "unknown";
  }
}

mirage_result mirage_client_error(const mirage_client* client, mirage_error* error) {
  if (!client || !error) return MIRAGE_BAD_ARGUMENT;
  const Failure& failure = client->failure;
  write_struct(*error, mirage_error{0, failure.result, failure.id.c_str(), failure.text.c_str(),
                                    failure.hint.c_str()});
  return MIRAGE_OK;
}

mirage_result mirage_client_create(const mirage_client_desc* desc, mirage_client** client) {
  if (!client) return MIRAGE_BAD_ARGUMENT;
  *client = nullptr;
  if (!desc || desc->size < 2 * sizeof(uint32_t)) return MIRAGE_BAD_ARGUMENT;
  try {
    const mirage_client_desc given = read_struct(*desc);
    const bool other = given.version / 1000000 != MIRAGE_CLIENT_VERSION_MAJOR;
    const std::string problem =
        other ? "version is not MIRAGE_CLIENT_VERSION of this library" : problem_of(given);
    if (!problem.empty()) {  // there is no client yet to ask for the text
      const Error error = make_error(ErrorId::kUsage, problem);
      if (given.log) given.log(given.user, MIRAGE_LOG_ERROR, error.line().c_str());
      return other ? MIRAGE_UNSUPPORTED : MIRAGE_BAD_ARGUMENT;
    }
    auto made = std::make_unique<mirage_client>();
    made->desc = given;
    made->name = given.name ? given.name : "libmirage-client";
    made->ca_file = given.ca_file ? given.ca_file : "";
    made->desc.name = made->desc.ca_file = nullptr;  // the caller's
    made->options.size = sizeof(mirage_options);
    *client = made.release();
    return MIRAGE_OK;
  } catch (const std::bad_alloc&) {
    return MIRAGE_OUT_OF_MEMORY;
  } catch (...) {
    return MIRAGE_INTERNAL;
  }
}

void mirage_client_destroy(mirage_client* client) {
  if (!client) return;
  // Names that are still there belong to a context that may not be current here.
  const gl::ForgetNames forget;
  client->client.close();
  delete client;
}

mirage_result mirage_connect(mirage_client* client, const char* url, const char* token) {
  return at_border(client, [&]() -> mirage_result {
    if (!url) return bad_argument(*client, "url is NULL");
    Result<ServerUrl> parsed = parse_url(url);
    if (!parsed) return fail(*client, parsed.error());
    parsed->ca_file = client->ca_file;
    client->token = token ? token : "";
    client->choice = parsed->choice;
    if (client->open) {
      client->client.session().set_token(client->token);
      client->client.session().choose(parsed->choice);
    }
    client->told_problem.clear();
    client->told_up = false;
    std::function<void()> wake;
    if (client->desc.wake) wake = [desc = client->desc] { desc.wake(desc.user); };
    client->link.connect(*parsed, std::move(wake));
    return MIRAGE_OK;
  });
}

mirage_result mirage_disconnect(mirage_client* client) {
  return at_border(client, [&]() -> mirage_result {
    client->link.drop();
    return MIRAGE_OK;
  });
}

mirage_result mirage_gl_attach(mirage_client* client) {
  return at_border(client, [&]() -> mirage_result {
    if (client->composite) return wrong_state(*client, "attached already");
    if (!any_context()) return no_context(*client);
    GLint major = 0, minor = 0;
    glGetIntegerv(GL_MAJOR_VERSION, &major);
    glGetIntegerv(GL_MINOR_VERSION, &minor);
    const int version = 10 * major + minor, needed = gl::is_embedded() ? 30 : 33;
    if (version < needed) {
      return fail(*client, MIRAGE_GRAPHICS,
                  make_error(ErrorId::kGraphicsDevice,
                             "the context has OpenGL" + std::string(needed == 30 ? " ES " : " ") +
                                 std::to_string(version / 10) + "." + std::to_string(version % 10),
                             "OpenGL 3.3 or OpenGL ES 3.0 is needed"));
    }
    const GlGuard guard;
    ClientGraphics graphics;
    graphics.atlas_edge = kAtlasEdge;
    graphics.atlas_layers =
        atlas_layers(client->desc.atlas_mb > 0 ? client->desc.atlas_mb : kAtlasMb);
    if (Result<void> attached = client->client.attach(graphics); !attached) {
      client->client.detach(false);
      return fail(*client, attached.error());
    }
    Result<Composite> composite = Composite::create();
    if (!composite) {
      client->client.detach(false);
      return fail(*client, composite.error());
    }
    client->composite = composite.take();
    client->context.emplace();
    client->gl_thread = std::this_thread::get_id();
    const bool software = gl::is_software();
    client->client.set_prices(*device_model(software ? "software" : "laptop"));
    client->usual_frame_ms = software ? kSoftwareFrameMs : kHardwareFrameMs;
    client->client.renderer().show_background(client->options.no_sky == 0);
    return MIRAGE_OK;
  });
}

mirage_result mirage_gl_detach(mirage_client* client, int32_t context_lost) {
  return at_border(client, [&]() -> mirage_result {
    if (!client->composite) return MIRAGE_OK;
    std::optional<gl::ForgetNames> forget;
    if (context_lost != 0) {
      forget.emplace();
    } else if (!client->context->here()) {
      return no_context(*client);
    }
    client->composite.reset();
    client->context.reset();
    client->client.detach(context_lost != 0);
    client->open = client->broken = false;
    client->planned.clear();
    client->told_drawable = false;
    client->link.reconnect();  // the next session begins anew
    return MIRAGE_OK;
  });
}

mirage_result mirage_update(mirage_client* client, int64_t now_us, uint32_t* events) {
  return on_gl_thread(client, [&]() -> mirage_result {
    if (events) *events = 0;
    if (now_us < client->now_us) return bad_argument(*client, "now_us went back");
    client->now_us = now_us;
    const GlGuard guard;
    open_session(*client);
    if (!client->open) return wrong_state(*client, "mirage_connect() comes first");
    const Result<void> updated = client->client.update(now_us);
    client->client.session().play(client->options.paused == 0, now_us);
    const std::uint32_t found = events_of(*client);
    if (events) *events = found;
    if (!updated) {
      tell(*client, MIRAGE_LOG_WARNING, updated.error());
      return fail(*client, updated.error());
    }
    return MIRAGE_OK;
  });
}
