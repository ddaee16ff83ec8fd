#pragma once
// Style sheet and script of the report's page.

namespace mirage {

/// The page's style sheet: light and dark, from a phone to a wide screen.
extern const char* const kPageStyle;
/// The page's script: moves the border between a drawn and a true picture.
extern const char* const kPageScript;

}  // namespace mirage
