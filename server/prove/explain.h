#pragma once
#include <string>

namespace mirage {

struct Proof;

struct PreparedScene;

/// Returns the need analysis as text: what is left out of the scene and of its objects, by which
/// rule and why. With a `proof` (else nullptr) it also says what that saves. `shadows`: enabled.
std::string explain_text(const PreparedScene& scene, bool shadows, const Proof* proof);
/// Returns the need analysis as one JSON document, for tools.
std::string explain_json(const PreparedScene& scene, bool shadows, const Proof* proof);

}  // namespace mirage
