#pragma once
// glTF fixture: small glTF files made in memory for the importer tests, and the words for their
// failures.

#include <gtest/gtest.h>

#include <string>

#include "tests/support/gltf_builder.h"

namespace mirage::test {

inline std::string failure(const Result<Scene>& scene) {
  return scene ? "loaded" : scene.error().line();
}

inline bool has_warning(const Scene& scene, const std::string& part) {
  for (const std::string& warning : scene.warnings) {
    if (warning.find(part) != std::string::npos) return true;
  }
  return false;
}

}  // namespace mirage::test

/// Expects that the load ends with this error, and that its text contains this part.
#define EXPECT_REFUSED(result, expected_id, part)                                            \
  do {                                                                                       \
    const auto& refused = (result);                                                          \
    ASSERT_FALSE(refused.ok()) << "loaded, but should be refused: " << (part);               \
    EXPECT_EQ(error_name(refused.error().id), error_name(ErrorId::expected_id))              \
        << refused.error().line();                                                           \
    EXPECT_NE(refused.error().text.find(part), std::string::npos) << refused.error().line(); \
  } while (false)
