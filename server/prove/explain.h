#pragma once
#include <string>

namespace mirage {

struct Proof;

struct PreparedScene;

/// The need analysis: what is left out of the scene and of its objects, by which rule, why, and
/// with a `proof` (else nullptr) what it saves. `shadows`: they were asked for.
std::string explain_text(const PreparedScene& scene, bool shadows, const Proof* proof);
/// The same for tools, one document.
std::string explain_json(const PreparedScene& scene, bool shadows, const Proof* proof);

}  // namespace mirage
