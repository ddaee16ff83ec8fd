#include "server/scene/gltf/draco_decode.h"

#ifdef MIRAGE_DRACO

#include <draco/compression/mesh/mesh_edgebreaker_decoder.h>
#include <draco/compression/mesh/mesh_sequential_decoder.h>

#include <cstring>
#include <exception>
#include <string>

#include "server/scene/gltf/gltf_limits.h"
#include "server/scene/gltf/model_check.h"

namespace mirage::gltf {
namespace {

Error bad_draco(const std::string& why) {
  return make_error(ErrorId::kSceneFormat, "Draco: " + why);
}

std::uint64_t attribute_bytes(const draco::PointCloud& cloud) {
  std::uint64_t point_bytes = 0;
  for (std::int32_t i = 0; i < cloud.num_attributes(); ++i) {
    const draco::PointAttribute* attribute = cloud.attribute(i);
    const std::uint64_t components = attribute->num_components();
    point_bytes += components * static_cast<std::uint64_t>(
                                    std::max(4, draco::DataTypeLength(attribute->data_type())));
  }
  return point_bytes * cloud.num_points();
}

/// Checks between connectivity and attributes, once the number of points is known and before
/// anything of that size is allocated. A bitstream of a hundred bytes can ask for gigabytes here.
template <typename Base>
class GuardedDecoder : public Base {
 public:
  explicit GuardedDecoder(const SceneLimits& limits) : limits_(limits) {}
  const std::optional<Error>& too_large() const { return too_large_; }

 protected:
  bool DecodeAllAttributes() override {
    const draco::PointCloud& cloud = *this->point_cloud();
    const std::uint64_t bytes = attribute_bytes(cloud);
    if (cloud.num_points() > limits_.vertices) {
      too_large_ = limits_.exceeded(cloud.num_points(), limits_.vertices, "vertices");
    } else if (bytes > limits_.draco_bytes) {
      too_large_ =
          limits_.exceeded(bytes, limits_.draco_bytes, "bytes of attributes in one mesh of Draco");
    }
    return !too_large_ && Base::DecodeAllAttributes();
  }

 private:
  const SceneLimits& limits_;
  std::optional<Error> too_large_;
};

template <typename Base>
Result<void> decode_with(std::span<const std::uint8_t> bytes, const SceneLimits& limits,
                         draco::Mesh& mesh) {
  draco::DecoderBuffer buffer;
  buffer.Init(reinterpret_cast<const char*>(bytes.data()), bytes.size());
  const draco::DecoderOptions options;
  GuardedDecoder<Base> decoder(limits);
  const draco::Status status = decoder.Decode(options, &buffer, &mesh);
  if (decoder.too_large()) return *decoder.too_large();
  if (!status.ok()) return bad_draco(status.error_msg_string());
  return {};
}

template <typename T>
bool convert(const draco::PointAttribute& attribute, std::uint32_t points, std::size_t components,
             std::vector<std::uint8_t>& out) {
  const std::size_t size = components * sizeof(T);
  out.resize(points * size);
  T values[4];
  for (std::uint32_t i = 0; i < points; ++i) {
    const draco::AttributeValueIndex at = attribute.mapped_index(draco::PointIndex(i));
    if (at.value() >= attribute.size()) return false;
    if (!attribute.ConvertValue<T>(at, static_cast<std::int8_t>(components), values)) return false;
    std::memcpy(&out[i * size], values, size);
  }
  return true;
}

bool convert_to(int component_type, const draco::PointAttribute& attribute, std::uint32_t points,
                std::size_t components, std::vector<std::uint8_t>& out) {
  switch (component_type) {
    case 5120:
      return convert<std::int8_t>(attribute, points, components, out);
    case 5121:
      return convert<std::uint8_t>(attribute, points, components, out);
    case 5122:
      return convert<std::int16_t>(attribute, points, components, out);
    case 5123:
      return convert<std::uint16_t>(attribute, points, components, out);
    case 5125:
      return convert<std::uint32_t>(attribute, points, components, out);
    default:
      return convert<float>(attribute, points, components, out);
  }
}

Result<DracoMesh> unpack(const draco::Mesh& mesh, std::span<const DracoAttribute> wanted) {
  DracoMesh out;
  out.points = mesh.num_points();
  out.indices.reserve(std::size_t{mesh.num_faces()} * 3);
  for (std::uint32_t f = 0; f < mesh.num_faces(); ++f) {
    for (const draco::PointIndex& corner : mesh.face(draco::FaceIndex(f))) {
      if (corner.value() >= out.points) return bad_draco("an index beyond its points");
      out.indices.push_back(corner.value());
    }
  }
  for (const DracoAttribute& want : wanted) {
    const std::string name = "attribute " + std::to_string(want.unique_id);
    const draco::PointAttribute* attribute = mesh.GetAttributeByUniqueId(want.unique_id);
    if (attribute == nullptr) return bad_draco("no " + name);
    if (want.components < 1 || want.components > 4 || component_bytes(want.component_type) == 0) {
      return bad_draco(name + " of an impossible type");
    }
    std::vector<std::uint8_t> values;
    if (!convert_to(want.component_type, *attribute, out.points, want.components, values)) {
      return bad_draco(name + " does not convert to its accessor's type");
    }
    out.attributes.push_back(std::move(values));
  }
  return out;
}

}  // namespace

bool has_draco() { return true; }

Result<DracoMesh> decode_draco(std::span<const std::uint8_t> bytes,
                               std::span<const DracoAttribute> wanted, const SceneLimits& limits) {
  if (const auto faces = peek_draco_faces(bytes, limits); !faces) return faces.error();
  try {
    draco::Mesh mesh;
    const bool edgebreaker = bytes[8] == 1;
    auto decoded = edgebreaker ? decode_with<draco::MeshEdgebreakerDecoder>(bytes, limits, mesh)
                               : decode_with<draco::MeshSequentialDecoder>(bytes, limits, mesh);
    if (!decoded) return decoded.error();
    return unpack(mesh, wanted);
  } catch (const std::bad_alloc&) {
    return make_error(ErrorId::kSceneLimit, "Draco: not enough memory");
  } catch (const std::exception& exception) {
    return bad_draco(exception.what());
  }
}

}  // namespace mirage::gltf

#else

namespace mirage::gltf {

bool has_draco() { return false; }

Result<DracoMesh> decode_draco(std::span<const std::uint8_t>, std::span<const DracoAttribute>,
                               const SceneLimits&) {
  return make_error(ErrorId::kSceneExtension,
                    "KHR_draco_mesh_compression: this build has no libdraco");
}

}  // namespace mirage::gltf

#endif
