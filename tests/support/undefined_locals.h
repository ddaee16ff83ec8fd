#pragma once
// Undefined locals: a shader in which every variable has a value before it is written. GLSL leaves
// it undefined, and most implementations happen to have a zero there. If a picture changes with the
// value, the shader reads something that it never wrote.

#include <string>

namespace mirage::test {

enum class Undefined { kNan, kZero };

/// Returns the shader `source` (GLSL, or GLSL ES 3.00) with its conditionals resolved, and with
/// every local, member of a local struct, output parameter and output set to `value` where it
/// begins. Integers and booleans have no NaN; instead of it they get a large number and true.
std::string with_defined_locals(const std::string& source, Undefined value);

}  // namespace mirage::test
