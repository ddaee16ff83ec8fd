#pragma once
// File kind: the name of a file that is no glTF, and how to make a glTF file of it.

#include <string>
#include <string_view>

namespace mirage::gltf {

struct FileKind {
  std::string name;  ///< with its article: "a ZIP archive"
  std::string hint;  ///< what to do next
};

/// Recognises the content of a file by its first bytes.
FileKind kind_of_file(std::string_view content);

}  // namespace mirage::gltf
