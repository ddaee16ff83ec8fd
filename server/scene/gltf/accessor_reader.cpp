#include "server/scene/gltf/accessor_reader.h"

#include <algorithm>
#include <cstring>
#include <string>

#include "server/scene/gltf/document.h"
#include "server/scene/gltf/model_check.h"

namespace mirage::gltf {
namespace {

template <typename T>
T load(const std::uint8_t* source) {
  T value;
  std::memcpy(&value, source, sizeof(T));
  return value;
}

float load_float(const std::uint8_t* source, int type, bool normalized) {
  switch (type) {
    case TINYGLTF_COMPONENT_TYPE_BYTE: {
      const float value = load<std::int8_t>(source);
      return normalized ? std::max(value / 127.0f, -1.0f) : value;
    }
    case TINYGLTF_COMPONENT_TYPE_UNSIGNED_BYTE: {
      const float value = load<std::uint8_t>(source);
      return normalized ? value / 255.0f : value;
    }
    case TINYGLTF_COMPONENT_TYPE_SHORT: {
      const float value = load<std::int16_t>(source);
      return normalized ? std::max(value / 32767.0f, -1.0f) : value;
    }
    case TINYGLTF_COMPONENT_TYPE_UNSIGNED_SHORT: {
      const float value = load<std::uint16_t>(source);
      return normalized ? value / 65535.0f : value;
    }
    case TINYGLTF_COMPONENT_TYPE_UNSIGNED_INT:
      return static_cast<float>(load<std::uint32_t>(source));
    default:
      return load<float>(source);
  }
}

Error absent_error(int accessor) {
  return make_error(ErrorId::kSceneReference, "accessors[" + std::to_string(accessor) +
                                                  "] uses a buffer that has no content");
}

/// Calls put(element, source bytes) for each element, sparse ones last so that they win.
template <typename Put>
Result<void> for_each_element(const Document& document, int index, Put put) {
  const tinygltf::Accessor& accessor = document.model.accessors[index];
  const std::size_t element =
      component_bytes(accessor.componentType) * component_count(accessor.type);
  if (accessor.bufferView >= 0) {
    const auto bytes = document.view_bytes(accessor.bufferView);
    if (bytes.empty()) return absent_error(index);
    const std::size_t declared = document.model.bufferViews[accessor.bufferView].byteStride;
    const std::size_t stride = declared != 0 ? declared : element;
    const std::uint8_t* source = bytes.data() + accessor.byteOffset;
    for (std::size_t i = 0; i < accessor.count; ++i) put(i, source + i * stride);
  }
  if (accessor.sparse.isSparse) {
    const auto& sparse = accessor.sparse;
    const auto places = document.view_bytes(sparse.indices.bufferView);
    const auto values = document.view_bytes(sparse.values.bufferView);
    if (places.empty() || values.empty()) return absent_error(index);
    const int type = sparse.indices.componentType;
    const std::uint8_t* place = places.data() + sparse.indices.byteOffset;
    const std::uint8_t* value = values.data() + sparse.values.byteOffset;
    for (int i = 0; i < sparse.count; ++i) {
      put(load_unsigned(place + i * component_bytes(type), type), value + i * element);
    }
  }
  return {};
}

/// Checks the type, and, before memory is taken, that there is content.
Result<void> check_components(const Document& document, int index, std::size_t components) {
  const tinygltf::Accessor& accessor = document.model.accessors[index];
  const std::size_t have = component_count(accessor.type);
  if (have == 0) {
    return make_error(ErrorId::kSceneReference,
                      "accessors[" + std::to_string(index) + "] cannot be used");
  }
  if (accessor.bufferView >= 0 && document.view_bytes(accessor.bufferView).empty()) {
    return absent_error(index);
  }
  if (have == components) return {};
  return make_error(ErrorId::kSceneFormat,
                    "accessors[" + std::to_string(index) + "] has " + std::to_string(have) +
                        " components, its use needs " + std::to_string(components));
}

}  // namespace

bool is_unsigned_type(int component_type) {
  return component_type == TINYGLTF_COMPONENT_TYPE_UNSIGNED_BYTE ||
         component_type == TINYGLTF_COMPONENT_TYPE_UNSIGNED_SHORT ||
         component_type == TINYGLTF_COMPONENT_TYPE_UNSIGNED_INT;
}

std::uint32_t load_unsigned(const std::uint8_t* source, int component_type) {
  switch (component_type) {
    case TINYGLTF_COMPONENT_TYPE_UNSIGNED_BYTE:
      return *source;
    case TINYGLTF_COMPONENT_TYPE_UNSIGNED_SHORT:
      return load<std::uint16_t>(source);
    default:
      return load<std::uint32_t>(source);
  }
}

Result<std::vector<float>> read_floats(const Document& document, int accessor,
                                       std::size_t components) {
  if (auto ok = check_components(document, accessor, components); !ok) return ok.error();
  const tinygltf::Accessor& info = document.model.accessors[accessor];
  const std::size_t size = component_bytes(info.componentType);
  std::vector<float> out(info.count * components, 0.0f);
  auto ok = for_each_element(document, accessor, [&](std::size_t i, const std::uint8_t* source) {
    for (std::size_t c = 0; c < components; ++c) {
      out[i * components + c] = load_float(source + c * size, info.componentType, info.normalized);
    }
  });
  if (!ok) return ok.error();
  return out;
}

Result<std::vector<std::uint32_t>> read_unsigned(const Document& document, int accessor,
                                                 std::size_t components) {
  if (auto ok = check_components(document, accessor, components); !ok) return ok.error();
  const tinygltf::Accessor& info = document.model.accessors[accessor];
  if (!is_unsigned_type(info.componentType)) {
    return make_error(ErrorId::kSceneFormat,
                      "accessors[" + std::to_string(accessor) + "] holds no unsigned integers");
  }
  const std::size_t size = component_bytes(info.componentType);
  std::vector<std::uint32_t> out(info.count * components, 0u);
  auto ok = for_each_element(document, accessor, [&](std::size_t i, const std::uint8_t* source) {
    for (std::size_t c = 0; c < components; ++c) {
      out[i * components + c] = load_unsigned(source + c * size, info.componentType);
    }
  });
  if (!ok) return ok.error();
  return out;
}

}  // namespace mirage::gltf
