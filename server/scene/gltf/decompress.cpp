#include "server/scene/gltf/decompress.h"

#include <algorithm>
#include <optional>
#include <string>
#include <utility>

#include "server/scene/gltf/draco_decode.h"
#include "server/scene/gltf/gltf_limits.h"
#include "server/scene/gltf/meshopt_decode.h"
#include "server/scene/gltf/model_check.h"

namespace mirage::gltf {
namespace {

using nlohmann::json;
using ByteSpan = std::span<const std::uint8_t>;

constexpr char kDraco[] = "KHR_draco_mesh_compression";
/// Memory for decoding besides the results: a triangle of three points of 96 bytes each, and the
/// tables of the connectivity.
constexpr std::uint64_t kDracoFaceBytes = 384;
constexpr std::uint64_t kDracoBatchBytes = 512ull << 20;

Error named(const std::string& what, const Error& error) {
  return make_error(error.id, what + ": " + error.text, error.hint);
}

json* extension(json& object, const char* name) {
  const auto list = object.find("extensions");
  if (list == object.end()) return nullptr;
  const auto found = list->find(name);
  return found == list->end() ? nullptr : &*found;
}

/// Returns the bytes that `place` ("buffer", "byteOffset", "byteLength") names.
Result<ByteSpan> bytes_at(const json& place, const Document& document) {
  const auto index = place["buffer"].get<std::size_t>();
  if (index >= document.buffers.size()) {
    return make_error(ErrorId::kSceneReference, "compressed data without a buffer");
  }
  const BufferData& buffer = document.buffers[index];
  const auto offset = place.value("byteOffset", std::uint64_t{0});
  const auto length = place["byteLength"].get<std::uint64_t>();
  if (buffer.absent) {
    return make_error(ErrorId::kSceneReference, "compressed data in a buffer without content");
  }
  if (offset + length > buffer.length) {
    return make_error(ErrorId::kSceneRange, "compressed data end at byte " +
                                                std::to_string(offset + length) +
                                                " of a buffer of " + std::to_string(buffer.length));
  }
  return buffer.data.subspan(static_cast<std::size_t>(offset), static_cast<std::size_t>(length));
}

std::size_t add_buffer(std::vector<std::uint8_t>&& bytes, Document& document) {
  BufferData buffer;
  buffer.owned = std::move(bytes);
  buffer.data = buffer.owned;
  buffer.length = buffer.owned.size();
  document.buffers.push_back(std::move(buffer));
  return document.buffers.size() - 1;
}

/// A limit on decoded bytes together with the bytes of the file.
class Allowance {
 public:
  explicit Allowance(const SceneLimits& limits) : limits_(limits) {}
  Result<void> take(std::uint64_t bytes) {
    used_ += bytes;
    if (used_ <= limits_.file_bytes) return {};
    return limits_.exceeded_at_least(used_, limits_.file_bytes, "bytes of decompressed geometry");
  }

 private:
  const SceneLimits& limits_;
  std::uint64_t used_ = 0;
};

struct ViewJob {
  std::size_t view = 0;
  ByteSpan bytes;
  MeshoptView how;
  std::vector<std::uint8_t> decoded;
  std::optional<Error> error;
};

std::string view_name(std::size_t view) { return "bufferViews[" + std::to_string(view) + "]"; }

Result<ViewJob> view_job(const json& source, std::size_t view, const Document& document) {
  auto how =
      meshopt_view(source["mode"].get<std::string>(), source.value("filter", std::string()),
                   source["count"].get<std::uint32_t>(), source["byteStride"].get<std::uint32_t>());
  if (!how) return named(view_name(view), how.error());
  auto bytes = bytes_at(source, document);
  if (!bytes) return named(view_name(view), bytes.error());
  ViewJob job;
  job.view = view;
  job.bytes = *bytes;
  job.how = *how;
  return job;
}

/// Forgives damaged data. What is too large, or what this build cannot decode, is an error: leaving
/// it out would hide what the user can mend.
Result<void> forgive_damage(const Error& error, std::string_view what, Tally& tally) {
  const bool damage = error.id == ErrorId::kSceneFormat || error.id == ErrorId::kSceneRange ||
                      error.id == ErrorId::kSceneReference;
  if (!damage) return error;
  return tally.lose(what, error);
}

constexpr std::string_view kBrokenViews = "compressed bufferViews that cannot be decoded left out";
constexpr std::string_view kBrokenMeshes = "compressed primitives that cannot be decoded left out";

/// Replaces a compressed bufferView by one without content.
void empty_view(json& view) { view = json{{"buffer", 0}, {"byteLength", 0}}; }

/// Leaves a compressed primitive nothing to draw.
void empty_primitive(json& primitive) {
  primitive["attributes"] = json::object();
  primitive.erase("indices");
  primitive.erase("targets");
  primitive["extensions"].erase(kDraco);
}

Result<std::vector<ViewJob>> find_views(json& root, const Document& document, Tally& tally) {
  std::vector<ViewJob> jobs;
  Allowance allowance(document.limits);
  const auto views = root.find("bufferViews");
  if (views == root.end()) return jobs;
  for (std::size_t i = 0; i < views->size(); ++i) {
    const json* source = nullptr;
    for (const char* name : kMeshoptExtensions) {
      if (source == nullptr) source = extension((*views)[i], name);
    }
    if (source == nullptr) continue;
    auto job = view_job(*source, i, document);
    if (!job) {
      auto forgiven = forgive_damage(job.error(), kBrokenViews, tally);
      if (!forgiven) return forgiven.error();
      empty_view((*views)[i]);
      continue;
    }
    auto ok = allowance.take(job->how.decoded_bytes());
    if (!ok) return named(view_name(i), ok.error());
    jobs.push_back(job.take());
  }
  return jobs;
}

std::size_t components_of(const std::string& type) {
  if (type == "SCALAR") return 1;
  return type == "VEC2" ? 2 : type == "VEC3" ? 3 : type == "VEC4" ? 4 : 0;
}

struct DracoJob {
  json* primitive = nullptr;
  std::string name;
  ByteSpan bytes;
  std::uint64_t cost = 0;              ///< most bytes in memory while it is decoded
  std::vector<std::string> semantics;  ///< of each requested attribute
  std::vector<DracoAttribute> wanted;
  DracoMesh mesh;
  std::optional<Error> error;
};

Result<DracoJob> draco_job(json& primitive, const json& source, const json& root,
                           const Document& document) {
  const json& view = root["bufferViews"][source["bufferView"].get<std::size_t>()];
  auto bytes = bytes_at(view, document);
  if (!bytes) return bytes.error();
  auto faces = peek_draco_faces(*bytes, document.limits);
  if (!faces) return faces.error();
  DracoJob job;
  job.primitive = &primitive;
  job.bytes = *bytes;
  job.cost = *faces * kDracoFaceBytes;
  for (const auto& [semantic, id] : source["attributes"].items()) {
    const auto accessor = primitive["attributes"].find(semantic);
    if (accessor == primitive["attributes"].end()) continue;
    const json& declared = root["accessors"][accessor->get<std::size_t>()];
    job.semantics.push_back(semantic);
    job.wanted.push_back({id.get<std::uint32_t>(), declared["componentType"].get<int>(),
                          components_of(declared["type"].get<std::string>())});
  }
  return job;
}

/// True if a viewer without Draco could draw this primitive.
bool has_plain_data(const json& primitive, const json& root) {
  for (const auto& [semantic, accessor] : primitive["attributes"].items()) {
    if (!root["accessors"][accessor.get<std::size_t>()].contains("bufferView")) return false;
  }
  return true;
}

Result<std::vector<DracoJob>> find_primitives(json& root, const Document& document, Tally& tally) {
  std::vector<DracoJob> jobs;
  std::uint64_t faces = 0;
  const auto meshes = root.find("meshes");
  if (meshes == root.end()) return jobs;
  for (std::size_t m = 0; m < meshes->size(); ++m) {
    json& primitives = (*meshes)[m]["primitives"];
    for (std::size_t p = 0; p < primitives.size(); ++p) {
      json* source = extension(primitives[p], kDraco);
      if (source == nullptr) continue;
      if (!has_draco() && has_plain_data(primitives[p], root)) continue;
      const std::string name =
          "meshes[" + std::to_string(m) + "].primitives[" + std::to_string(p) + "]";
      auto job = draco_job(primitives[p], *source, root, document);
      if (!job) {
        auto ok = forgive_damage(named(name, job.error()), kBrokenMeshes, tally);
        if (!ok) return ok.error();
        empty_primitive(primitives[p]);
        continue;
      }
      faces += job->cost / kDracoFaceBytes;
      if (const std::uint64_t most = document.limits.draco_faces_in_file; faces > most) {
        return document.limits.exceeded_at_least(faces, most, "triangles of Draco");
      }
      job->name = name;
      jobs.push_back(job.take());
    }
  }
  return jobs;
}

/// Makes an accessor like `declared` over `bytes`. It replaces `declared` if that has no data and
/// is not filled yet, else it is a new one.
std::size_t fill_accessor(std::size_t declared, std::uint32_t count, int component_type,
                          std::vector<std::uint8_t>&& bytes, json& root, Document& document) {
  const std::size_t length = bytes.size();
  const std::size_t buffer = add_buffer(std::move(bytes), document);
  root["bufferViews"].push_back({{"buffer", buffer}, {"byteLength", length}});
  json& accessors = root["accessors"];
  std::size_t place = declared;
  if (accessors[declared].contains("bufferView")) {
    place = accessors.size();
    json copy = accessors[declared];
    accessors.push_back(std::move(copy));
  }
  json& accessor = accessors[place];
  accessor["bufferView"] = root["bufferViews"].size() - 1;
  accessor["byteOffset"] = 0;
  accessor["componentType"] = component_type;
  accessor["count"] = count;
  accessor.erase("sparse");
  return place;
}

/// Forgives counts that differ from the declared ones, because viewers never check those.
Result<void> check_counts(const DracoJob& job, const json& root, Tally& tally) {
  const auto differs = [&](const json& accessor, std::size_t count) {
    return root["accessors"][accessor.get<std::size_t>()]["count"].get<std::uint64_t>() != count;
  };
  const json& primitive = *job.primitive;
  bool other = primitive.contains("indices") && primitive.value("mode", 4) == 4 &&
               differs(primitive["indices"], job.mesh.indices.size());
  for (const std::string& semantic : job.semantics) {
    other = other || differs(primitive["attributes"][semantic], job.mesh.points);
  }
  if (!other) return {};
  return tally.forgive(
      "Draco meshes of other counts than declared",
      make_error(ErrorId::kSceneRange,
                 job.name + ": Draco: " + std::to_string(job.mesh.points) + " points and " +
                     std::to_string(job.mesh.indices.size()) + " indices, declared are others"));
}

void put_back(DracoJob& job, json& root, Document& document) {
  json& primitive = *job.primitive;
  std::vector<std::uint8_t> bytes(job.mesh.indices.size() * 4);
  if (!bytes.empty()) std::memcpy(bytes.data(), job.mesh.indices.data(), bytes.size());
  const auto count = static_cast<std::uint32_t>(job.mesh.indices.size());
  if (count > 0) {
    if (!primitive.contains("indices")) {
      root["accessors"].push_back({{"type", "SCALAR"}});
      primitive["indices"] = root["accessors"].size() - 1;
    }
    primitive["indices"] = fill_accessor(primitive["indices"].get<std::size_t>(), count, 5125,
                                         std::move(bytes), root, document);
    root["accessors"][primitive["indices"].get<std::size_t>()]["type"] = "SCALAR";
  }
  primitive["mode"] = 4;  // decoding gives triangles, even for a strip
  for (std::size_t i = 0; i < job.semantics.size(); ++i) {
    json& accessor = primitive["attributes"][job.semantics[i]];
    accessor =
        fill_accessor(accessor.get<std::size_t>(), job.mesh.points, job.wanted[i].component_type,
                      std::move(job.mesh.attributes[i]), root, document);
  }
}

/// Returns the end of the jobs from `begin` that may be decoded at the same time.
std::size_t batch_end(const std::vector<DracoJob>& jobs, std::size_t begin) {
  std::uint64_t cost = jobs[begin].cost;
  std::size_t end = begin + 1;
  while (end < jobs.size() && cost + jobs[end].cost <= kDracoBatchBytes) cost += jobs[end++].cost;
  return end;
}

}  // namespace

Result<void> decompress_views(json& root, Document& document, const Workers& workers,
                              Tally& tally) {
  auto jobs = find_views(root, document, tally);
  if (!jobs) return jobs.error();
  workers.each(jobs->size(), [&](std::size_t i) {
    ViewJob& job = (*jobs)[i];
    auto decoded = decode_meshopt(job.bytes, job.how);
    if (decoded) {
      job.decoded = decoded.take();
    } else {
      job.error = decoded.error();
    }
  });
  for (ViewJob& job : *jobs) {
    json& view = root["bufferViews"][job.view];
    if (job.error) {
      auto ok = forgive_damage(named(view_name(job.view), *job.error), kBrokenViews, tally);
      if (!ok) return ok;
      empty_view(view);
      continue;
    }
    view["byteOffset"] = 0;
    view["byteLength"] = job.decoded.size();
    view["buffer"] = add_buffer(std::move(job.decoded), document);
    view.erase("extensions");
  }
  return {};
}

Result<void> decompress_primitives(json& root, Document& document, const Workers& workers,
                                   Tally& tally) {
  auto jobs = find_primitives(root, document, tally);
  if (!jobs) return jobs.error();
  Allowance allowance(document.limits);
  for (std::size_t begin = 0; begin < jobs->size();) {
    const std::size_t end = batch_end(*jobs, begin);
    workers.each(end - begin, [&](std::size_t i) {
      DracoJob& job = (*jobs)[begin + i];
      auto mesh = decode_draco(job.bytes, job.wanted, document.limits);
      if (mesh) {
        job.mesh = mesh.take();
      } else {
        job.error = mesh.error();
      }
    });
    for (; begin < end; ++begin) {
      DracoJob& job = (*jobs)[begin];
      if (job.error) {
        auto ok = forgive_damage(named(job.name, *job.error), kBrokenMeshes, tally);
        if (!ok) return ok;
        empty_primitive(*job.primitive);
        continue;
      }
      std::uint64_t bytes = job.mesh.indices.size() * 4;
      for (const auto& attribute : job.mesh.attributes) bytes += attribute.size();
      if (auto ok = allowance.take(bytes); !ok) return ok.error();
      if (auto ok = check_counts(job, root, tally); !ok) return ok.error();
      put_back(job, root, document);
    }
  }
  return {};
}

}  // namespace mirage::gltf
