#pragma once
// A web address as a QR code for phones, in characters of a terminal.

#include <string>

namespace mirage {

/// Returns the QR code of `text` in lines of UTF-8, two rows of modules a line, light on the
/// terminal's dark ground, with the light border that readers need. Empty: this build has no
/// libqrencode, or the text is too long (2,900 bytes).
std::string qr_code(const std::string& text);

}  // namespace mirage
