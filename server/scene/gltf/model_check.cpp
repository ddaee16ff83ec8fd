#include "server/scene/gltf/model_check.h"

#include <cstring>
#include <string>

#include "server/scene/gltf/accessor_reader.h"
#include "server/scene/gltf/document.h"
#include "server/scene/gltf/gltf_limits.h"

namespace mirage::gltf {
namespace {

std::string at(const char* list, std::size_t index) {
  return std::string(list) + "[" + std::to_string(index) + "]";
}

Error range_error(const std::string& what, const std::string& why) {
  return make_error(ErrorId::kSceneRange, what + " " + why);
}

Result<void> check_view(const Document& document, std::size_t index) {
  const tinygltf::BufferView& view = document.model.bufferViews[index];
  const std::string what = at("bufferViews", index);
  if (static_cast<std::size_t>(view.buffer) >= document.buffers.size()) {
    return range_error(what, "has no buffer");
  }
  const BufferData& buffer = document.buffers[view.buffer];
  if (buffer.absent) return {};  // whoever reads it finds nothing
  const std::uint64_t length = buffer.length;
  // Sums of values below 2^31 cannot wrap in 64 bits.
  if (std::uint64_t{view.byteOffset} + view.byteLength > length) {
    return range_error(what, "ends at byte " + std::to_string(view.byteOffset + view.byteLength) +
                                 " of a buffer of " + std::to_string(length));
  }
  return {};
}

/// Checks that `count` elements of `element` bytes, `stride` apart from `offset`, are inside
/// bufferView `view`.
Result<void> check_span(const Document& document, int view, std::uint64_t offset,
                        std::uint64_t count, std::uint64_t stride, std::uint64_t element,
                        const std::string& what) {
  const std::uint64_t length = document.model.bufferViews[view].byteLength;
  const std::uint64_t end = offset + stride * (count - 1) + element;
  if (end <= length) return {};
  return range_error(what, "needs " + std::to_string(end) + " bytes of bufferViews[" +
                               std::to_string(view) + "], which has " + std::to_string(length));
}

/// Sparse indices must increase strictly and stay below the count of the accessor.
Result<void> check_sparse_order(const Document& document, std::size_t index) {
  const tinygltf::Accessor& accessor = document.model.accessors[index];
  const auto bytes = document.view_bytes(accessor.sparse.indices.bufferView);
  if (bytes.empty()) return {};
  const int type = accessor.sparse.indices.componentType;
  const std::uint8_t* source = bytes.data() + accessor.sparse.indices.byteOffset;
  std::int64_t last = -1;
  for (int i = 0; i < accessor.sparse.count; ++i) {
    const std::int64_t value = load_unsigned(source + i * component_bytes(type), type);
    if (value <= last || value >= static_cast<std::int64_t>(accessor.count)) {
      return range_error(at("accessors", index), "has sparse index " + std::to_string(value) +
                                                     " at place " + std::to_string(i) +
                                                     ", not increasing below its count");
    }
    last = value;
  }
  return {};
}

Result<void> check_sparse(const Document& document, std::size_t index, std::uint64_t element) {
  const tinygltf::Accessor& accessor = document.model.accessors[index];
  const auto& sparse = accessor.sparse;
  const std::string what = at("accessors", index) + ".sparse";
  if (sparse.count < 1 || static_cast<std::uint64_t>(sparse.count) > accessor.count) {
    return range_error(what, "has count " + std::to_string(sparse.count) + " of " +
                                 std::to_string(accessor.count));
  }
  if (!is_unsigned_type(sparse.indices.componentType)) {
    return make_error(ErrorId::kSceneFormat, what + ".indices are of component type " +
                                                 std::to_string(sparse.indices.componentType));
  }
  const auto count = static_cast<std::uint64_t>(sparse.count);
  const std::uint64_t size = component_bytes(sparse.indices.componentType);
  auto ok = check_span(document, sparse.indices.bufferView,
                       static_cast<std::uint64_t>(sparse.indices.byteOffset), count, size, size,
                       what + ".indices");
  if (!ok) return ok;
  ok = check_span(document, sparse.values.bufferView,
                  static_cast<std::uint64_t>(sparse.values.byteOffset), count, element, element,
                  what + ".values");
  if (!ok) return ok;
  return check_sparse_order(document, index);
}

Result<void> check_accessor(const Document& document, std::size_t index) {
  const tinygltf::Accessor& accessor = document.model.accessors[index];
  const std::string what = at("accessors", index);
  const std::uint64_t component = component_bytes(accessor.componentType);
  const std::uint64_t element = component * component_count(accessor.type);
  if (element == 0) {
    return make_error(ErrorId::kSceneFormat, what + " has component type " +
                                                 std::to_string(accessor.componentType) +
                                                 ", which glTF does not know");
  }
  if (accessor.count < 1) return range_error(what, "has count 0");
  if (accessor.bufferView >= 0) {
    const std::uint64_t declared = document.model.bufferViews[accessor.bufferView].byteStride;
    const std::uint64_t stride = declared != 0 ? declared : element;
    if (stride < element || stride % component != 0) {
      return range_error(what, "cannot have byteStride " + std::to_string(stride) +
                                   " with elements of " + std::to_string(element) + " bytes");
    }
    auto ok = check_span(document, accessor.bufferView, accessor.byteOffset, accessor.count, stride,
                         element, what);
    if (!ok) return ok;
  } else if (accessor.count > kMaxZeroElements) {
    return make_error(ErrorId::kSceneLimit, what + " has " + std::to_string(accessor.count) +
                                                " elements without data, at most " +
                                                std::to_string(kMaxZeroElements));
  }
  if (accessor.sparse.isSparse) return check_sparse(document, index, element);
  return {};
}

/// Makes every use of the bufferView find nothing.
void empty_view(tinygltf::BufferView& view) { view.byteLength = 0; }

/// Makes every use of the accessor an error (check_components() of accessor_reader.cpp).
void empty_accessor(tinygltf::Accessor& accessor) {
  accessor.type = -1;
  accessor.count = 0;
  accessor.bufferView = -1;
  accessor.sparse.isSparse = false;
}

}  // namespace

std::size_t component_bytes(int component_type) {
  switch (component_type) {
    case TINYGLTF_COMPONENT_TYPE_BYTE:
    case TINYGLTF_COMPONENT_TYPE_UNSIGNED_BYTE:
      return 1;
    case TINYGLTF_COMPONENT_TYPE_SHORT:
    case TINYGLTF_COMPONENT_TYPE_UNSIGNED_SHORT:
      return 2;
    case TINYGLTF_COMPONENT_TYPE_UNSIGNED_INT:
    case TINYGLTF_COMPONENT_TYPE_FLOAT:
      return 4;
    default:
      return 0;
  }
}

std::size_t component_count(int type) {
  switch (type) {
    case TINYGLTF_TYPE_SCALAR:
      return 1;
    case TINYGLTF_TYPE_VEC2:
      return 2;
    case TINYGLTF_TYPE_VEC3:
      return 3;
    case TINYGLTF_TYPE_VEC4:
    case TINYGLTF_TYPE_MAT2:
      return 4;
    case TINYGLTF_TYPE_MAT3:
      return 9;
    case TINYGLTF_TYPE_MAT4:
      return 16;
    default:
      return 0;
  }
}

Result<void> check_model(Document& document, Tally& tally) {
  tinygltf::Model& model = document.model;
  for (std::size_t i = 0; i < model.bufferViews.size(); ++i) {
    const auto checked = check_view(document, i);
    if (checked) continue;
    if (auto ok = tally.lose("bufferViews that cannot be used", checked.error()); !ok) return ok;
    empty_view(model.bufferViews[i]);
  }
  for (std::size_t i = 0; i < model.accessors.size(); ++i) {
    const auto checked = check_accessor(document, i);
    if (checked) continue;
    if (auto ok = tally.lose("accessors that cannot be used", checked.error()); !ok) return ok;
    empty_accessor(model.accessors[i]);
  }
  return {};
}

}  // namespace mirage::gltf
