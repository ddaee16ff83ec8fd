#include "server/scene/gltf/meshopt_decode.h"

#include <meshoptimizer.h>

#include <string>

#include "server/scene/gltf/gltf_limits.h"

namespace mirage::gltf {
namespace {

// Sixteen equal bytes of a column take two bits, the shortest form there is.
constexpr std::uint64_t kMaxVertexRatio = 64;
// Allows for the block of the first vertex and the unused end of a block.
constexpr std::uint64_t kVertexSlackBytes = 256 * 256;

Error bad_meshopt(const std::string& why) {
  return make_error(ErrorId::kSceneFormat, "meshopt: " + why);
}

/// Checks the sizes that the extension demands, because the decoders assert them.
Result<void> check_sizes(const MeshoptView& view) {
  const std::uint32_t stride = view.stride;
  bool fits = false;
  switch (view.mode) {
    case MeshoptMode::kAttributes:
      fits = stride > 0 && stride <= 256 && stride % 4 == 0;
      break;
    case MeshoptMode::kTriangles:
      if (view.count % 3 != 0) return bad_meshopt("TRIANGLES of no whole triangles");
      fits = stride == 2 || stride == 4;
      break;
    case MeshoptMode::kIndices:
      fits = stride == 2 || stride == 4;
      break;
  }
  if (view.filter == MeshoptFilter::kOctahedral) fits = fits && (stride == 4 || stride == 8);
  if (view.filter == MeshoptFilter::kQuaternion) fits = fits && stride == 8;
  if (view.filter != MeshoptFilter::kNone && view.mode != MeshoptMode::kAttributes) {
    return bad_meshopt("a filter on indices");
  }
  if (!fits) return bad_meshopt("byteStride " + std::to_string(stride) + " does not fit its mode");
  if (view.decoded_bytes() > kMaxMeshoptBytes) {
    return make_error(ErrorId::kSceneLimit,
                      "meshopt: " + std::to_string(view.decoded_bytes()) + " bytes are too many");
  }
  return {};
}

/// The first byte is codec and version: 0xa0 vertices, 0xe0/0xe1 triangles, 0xd0/0xd1 indices.
Result<void> check_header(std::span<const std::uint8_t> bytes, MeshoptMode mode) {
  if (bytes.empty()) return bad_meshopt("no data");
  const int codec = bytes[0] & 0xf0;
  const int version = bytes[0] & 0x0f;
  const int wanted = mode == MeshoptMode::kAttributes  ? 0xa0
                     : mode == MeshoptMode::kTriangles ? 0xe0
                                                       : 0xd0;
  if (codec != wanted) return bad_meshopt("the data are of another mode");
  if (version > (mode == MeshoptMode::kAttributes ? 0 : 1)) {
    return make_error(ErrorId::kSceneExtension,
                      "meshopt: bitstream version " + std::to_string(version) + " is not read",
                      "npx @gltf-transform/cli copy IN.glb OUT.glb writes it uncompressed");
  }
  return {};
}

void apply_filter(const MeshoptView& view, std::uint8_t* data) {
  switch (view.filter) {
    case MeshoptFilter::kNone:
      break;
    case MeshoptFilter::kOctahedral:
      meshopt_decodeFilterOct(data, view.count, view.stride);
      break;
    case MeshoptFilter::kQuaternion:
      meshopt_decodeFilterQuat(data, view.count, view.stride);
      break;
    case MeshoptFilter::kExponential:
      meshopt_decodeFilterExp(data, view.count, view.stride);
      break;
  }
}

}  // namespace

Result<MeshoptView> meshopt_view(std::string_view mode, std::string_view filter,
                                 std::uint32_t count, std::uint32_t stride) {
  MeshoptView view;
  view.count = count;
  view.stride = stride;
  if (mode == "TRIANGLES") {
    view.mode = MeshoptMode::kTriangles;
  } else if (mode == "INDICES") {
    view.mode = MeshoptMode::kIndices;
  } else if (mode != "ATTRIBUTES") {
    return bad_meshopt("unknown mode '" + std::string(mode.substr(0, 40)) + "'");
  }
  if (filter == "OCTAHEDRAL") {
    view.filter = MeshoptFilter::kOctahedral;
  } else if (filter == "QUATERNION") {
    view.filter = MeshoptFilter::kQuaternion;
  } else if (filter == "EXPONENTIAL") {
    view.filter = MeshoptFilter::kExponential;
  } else if (filter == "COLOR") {
    return make_error(ErrorId::kSceneExtension, "meshopt: the filter COLOR is not read",
                      "npx @gltf-transform/cli copy IN.glb OUT.glb writes it uncompressed");
  } else if (!filter.empty() && filter != "NONE") {
    return bad_meshopt("unknown filter '" + std::string(filter.substr(0, 40)) + "'");
  }
  return view;
}

Result<std::vector<std::uint8_t>> decode_meshopt(std::span<const std::uint8_t> bytes,
                                                 const MeshoptView& view) {
  if (auto ok = check_sizes(view); !ok) return ok.error();
  if (auto ok = check_header(bytes, view.mode); !ok) return ok.error();
  // The index codecs also refuse data too short for its count, but only after allocating. A
  // triangle, and an index, takes at least a byte.
  const std::uint64_t most = view.mode == MeshoptMode::kAttributes
                                 ? bytes.size() * kMaxVertexRatio + kVertexSlackBytes
                                 : bytes.size() * 3 * view.stride;
  if (view.decoded_bytes() > most) return bad_meshopt("fewer bytes than its count needs");
  std::vector<std::uint8_t> out(static_cast<std::size_t>(view.decoded_bytes()));
  if (view.count == 0) return out;
  int status = 0;
  switch (view.mode) {
    case MeshoptMode::kAttributes:
      status = meshopt_decodeVertexBuffer(out.data(), view.count, view.stride, bytes.data(),
                                          bytes.size());
      break;
    case MeshoptMode::kTriangles:
      status = meshopt_decodeIndexBuffer(out.data(), view.count, view.stride, bytes.data(),
                                         bytes.size());
      break;
    case MeshoptMode::kIndices:
      status = meshopt_decodeIndexSequence(out.data(), view.count, view.stride, bytes.data(),
                                           bytes.size());
      break;
  }
  if (status != 0) return bad_meshopt("damaged data (" + std::to_string(status) + ")");
  apply_filter(view, out.data());
  return out;
}

}  // namespace mirage::gltf
