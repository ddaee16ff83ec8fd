// Calls of mirage/frame.h that look into a view: what lies under a pixel, and the server's render.
#include "client/frame/planned_frame.h"
#include "client/library/handle.h"
#include "client/scene/scene_view.h"
#include "client/screen/pilot.h"
#include "client/session/client_session.h"

using namespace mirage;           // NOLINT: the border between C and the library
using namespace mirage::library;  // NOLINT

mirage_result mirage_depth_at(const mirage_client* client, int32_t view, double x, double y,
                              double* distance) {
  return at_border(client, [&]() -> mirage_result {
    if (const auto no = not_planned(*client, view)) return *no;
    const Camera& camera = client->client.planned(static_cast<std::size_t>(view)).camera;
    const bool inside = x >= 0 && y >= 0 && x <= camera.width && y <= camera.height;
    if (!distance || !inside) return bad_argument(*client, "the place is outside of the picture");
    const std::optional<Seen> seen =
        seen_at(client->client.session().scene(), camera, {x / camera.width, y / camera.height});
    if (!seen) return MIRAGE_NOT_YET;
    *distance = glm::dot(seen->point - camera.pose.eye, camera.forward()) * client->placement.scale;
    return MIRAGE_OK;
  });
}

mirage_result mirage_reference_ask(mirage_client* client, const mirage_view* view) {
  return at_border(client, [&]() -> mirage_result {
    if (!client->open) return wrong_state(*client, "mirage_update() comes first");
    if (!view || view->size < sizeof(uint32_t)) return bad_argument(*client, "there is no view");
    std::string problem;
    const std::optional<PlannedView> seen = read_view(*client, read_struct(*view), problem);
    if (!seen) return bad_argument(*client, problem);
    constexpr std::uint32_t kSupersample = 4;
    client->client.session().ask_reference(seen->camera, kSupersample);
    return MIRAGE_OK;
  });
}

mirage_result mirage_reference_take(mirage_client* client, mirage_image* image) {
  return at_border(client, [&]() -> mirage_result {
    if (!client->open) return wrong_state(*client, "mirage_update() comes first");
    if (!image) return bad_argument(*client, "image is NULL");
    ClientSession& session = client->client.session();
    std::optional<ReferenceFrame> frame = session.take_reference();
    if (!frame && session.reference_refused()) {
      return fail(*client, make_error(ErrorId::kComparison, "the server gives no full renders",
                                      "mirage-server --references"));
    }
    if (!frame) return MIRAGE_NOT_YET;
    client->reference = std::move(*frame);
    mirage_image out{};
    out.width = static_cast<std::int32_t>(client->reference->width);
    out.height = static_cast<std::int32_t>(client->reference->height);
    out.rgba = client->reference->rgba.data();
    out.bytes = client->reference->rgba.size();
    write_struct(*image, out);
    return MIRAGE_OK;
  });
}
