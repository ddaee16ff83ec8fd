#pragma once
// Web figures: what the page's strip shows of a client.

#include <cstdint>
#include <string>

namespace mirage {

class Client;
struct LinkTraffic;

/// Returns the figures at a time of the session, as JSON.
std::string web_figures(const Client& client, const LinkTraffic& traffic,
                        std::uint64_t drawn_frames, std::int64_t now_us);

}  // namespace mirage
