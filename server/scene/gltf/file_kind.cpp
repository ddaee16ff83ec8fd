#include "server/scene/gltf/file_kind.h"

#include <algorithm>
#include <cctype>
#include <cstdint>
#include <cstring>
#include <optional>

namespace mirage::gltf {
namespace {

constexpr char kAssimp[] = "assimp export IN OUT.glb (Debian: assimp-utils)";
constexpr char kBlender[] = "import it into Blender and export glTF 2.0";
constexpr char kUnpack[] = "unpack it and open the .glb or .gltf file in it";
constexpr char kAgain[] = "download the file again";
constexpr char kImage[] = "open the .glb or .gltf file that uses it";
constexpr char kTile[] = "npx 3d-tiles-tools b3dmToGlb -i IN -o OUT.glb";

struct Magic {
  std::string_view bytes;
  const char* name;
  const char* hint;
};
constexpr Magic kMagics[] = {
    {"version https://git-lfs", "a Git LFS pointer, not the file itself", "git lfs pull"},
    {"\x89PNG", "a PNG image", kImage},
    {"\xff\xd8\xff", "a JPEG image", kImage},
    {"\xabKTX", "a KTX image", kImage},
    {"RIFF", "a RIFF file, such as a WebP image", kImage},
    {"PK\x03\x04", "a ZIP archive (perhaps USDZ or 3MF)", kUnpack},
    {"\x1f\x8b", "a gzip archive", kUnpack},
    {"\x28\xb5\x2f\xfd", "a zstd archive", kUnpack},
    {"7z\xbc\xaf", "a 7z archive", kUnpack},
    {"Rar!", "a RAR archive", kUnpack},
    {"Kaydara FBX Binary", "an FBX file", kAssimp},
    {"; FBX", "an FBX file", kAssimp},
    {"PXR-USDC", "a USD file", kBlender},
    {"#usda", "a USD file", kBlender},
    {"BLENDER", "a Blender file",
     "blender IN --background --python-expr "
     "\"import bpy; bpy.ops.export_scene.gltf(filepath='OUT.glb')\""},
    {"ply\n", "a PLY file", kAssimp},
    {"ply\r", "a PLY file", kAssimp},
    {"MM", "a 3DS file", kAssimp},
    {"LASF", "a LAS point cloud", "convert it to glTF points, for example with CloudCompare"},
    {"b3dm", "a tile of 3D Tiles (b3dm)", kTile},
    {"i3dm", "a tile of 3D Tiles (i3dm)", "npx 3d-tiles-tools i3dmToGlb -i IN -o OUT.glb"},
    {"cmpt", "a tile of 3D Tiles (cmpt)", "npx 3d-tiles-tools cmptToGlb -i IN -o OUT.glb"},
    {"pnts", "a tile of 3D Tiles (pnts)", "npx 3d-tiles-tools convertPntsToGlb -i IN -o OUT.glb"},
    {"AC10", "a DWG drawing", "export glTF 2.0, or IFC or STEP, from the CAD program"},
};

bool contains(std::string_view text, std::string_view part) {
  return text.find(part) != std::string_view::npos;
}

std::string lower(std::string_view text) {
  std::string out(text);
  std::transform(out.begin(), out.end(), out.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return out;
}

/// Formats of text whose first line is not fixed.
std::optional<FileKind> kind_of_text(std::string_view start) {
  const std::string text = lower(start);
  const std::size_t first = text.find_first_not_of(" \t\r\n");
  const std::string_view begin =
      first == std::string::npos ? std::string_view() : std::string_view(text).substr(first);
  if (begin.starts_with("iso-10303-21")) {
    if (contains(begin, "'ifc"))
      return FileKind{"an IFC file", "IfcConvert IN OUT.glb (IfcOpenShell)"};
    return FileKind{"a STEP file", "import it into FreeCAD and export glTF"};
  }
  if (begin.starts_with("<")) {
    if (contains(begin, "<collada")) return FileKind{"a COLLADA file", kAssimp};
    if (contains(begin, "<x3d")) return FileKind{"an X3D file", kAssimp};
    if (contains(begin, "<html") || contains(begin, "<!doctype html")) {
      return FileKind{"an HTML page, perhaps an error page", kAgain};
    }
    return FileKind{"an HTML or XML page", kAgain};
  }
  if (begin.starts_with("solid") && contains(begin, "facet"))
    return FileKind{"an STL file", kAssimp};
  if (begin.starts_with("#vrml")) return FileKind{"a VRML file", kAssimp};
  const bool obj = begin.starts_with("v ") || begin.starts_with("mtllib ") ||
                   contains(begin, "\nv ") || contains(begin, "\nmtllib ");
  if (obj) return FileKind{"a Wavefront OBJ file", "npx obj2gltf -i IN -o OUT.glb"};
  return std::nullopt;
}

/// Binary STL: a header of 80 bytes, a count, and 50 bytes for each triangle.
bool is_binary_stl(std::string_view content) {
  constexpr std::size_t kHeader = 84, kTriangle = 50;
  if (content.size() < kHeader) return false;
  std::uint32_t count = 0;
  std::memcpy(&count, content.data() + kHeader - 4, 4);
  return content.size() == kHeader + kTriangle * std::uint64_t{count};
}

}  // namespace

FileKind kind_of_file(std::string_view content) {
  constexpr std::size_t kLooked = 4096;
  if (is_binary_stl(content)) return {"an STL file", kAssimp};
  for (const Magic& magic : kMagics) {
    if (content.starts_with(magic.bytes)) return {magic.name, magic.hint};
  }
  const std::optional<FileKind> text = kind_of_text(content.substr(0, kLooked));
  return text ? *text : FileKind{"neither GLB nor JSON", ""};
}

}  // namespace mirage::gltf
