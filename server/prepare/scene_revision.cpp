#include "server/prepare/scene_revision.h"

#include <xxhash.h>

#include "protocol/codec/animation_codec.h"
#include "protocol/codec/model_codec.h"

namespace mirage {
namespace {

class ContentHash {
 public:
  ContentHash() : state_(XXH3_createState()) { XXH3_64bits_reset(state_); }
  ContentHash(const ContentHash&) = delete;
  ContentHash& operator=(const ContentHash&) = delete;
  ~ContentHash() { XXH3_freeState(state_); }
  void add(const void* bytes, std::size_t n) {
    if (n > 0) XXH3_64bits_update(state_, bytes, n);
  }
  template <typename T>
  void add_array(const std::vector<T>& v) {
    add(v.data(), v.size() * sizeof(T));
  }
  std::uint64_t value() const { return XXH3_64bits_digest(state_); }

 private:
  XXH3_state_t* state_;
};

// Raise it when equal content gives other tiles, by build_lods() or by the grouping: stored tiles
// outlive a build. The renderer and encoders are covered by the profile (render_profile.h).
constexpr std::uint32_t kTileVersion = 10;

}  // namespace

std::uint64_t scene_revision(const Scene& scene) {
  ContentHash hash;
  hash.add(&kTileVersion, sizeof(kTileVersion));
  for (const SceneObject& object : scene.objects) {
    hash.add_array(object.mesh.vertices);
    hash.add_array(object.mesh.indices);
    hash.add_array(encode_animation(object.animation.get()));
    hash.add_array(object.track.places);
    // Objects of one base may share its levels of detail.
    if (object.baked) {
      hash.add(&object.baked->base, sizeof(object.baked->base));
      hash.add(&object.baked->shape, sizeof(object.baked->shape));
    }
    for (const Primitive& p : object.mesh.primitives) {
      const std::uint32_t words[4] = {static_cast<std::uint32_t>(p.kind), p.first_index,
                                      p.index_count, p.material};
      hash.add(words, sizeof(words));
    }
  }
  hash.add_array(encode_materials(scene.materials));
  for (const Image& image : scene.images) {
    const std::uint32_t size[3] = {image.width, image.height, image.srgb};
    hash.add(size, sizeof(size));
    hash.add_array(image.rgba);
  }
  // Poses count: groups show where their members are, and neighbours cast shadows.
  for (const Instance& instance : scene.instances) {
    const Similarity& m = instance.world_from_object;
    const double place[] = {m.position.x, m.position.y, m.position.z, m.rotation.w,
                            m.rotation.x, m.rotation.y, m.rotation.z, m.scale};
    hash.add(&instance.object, sizeof(instance.object));
    hash.add(place, sizeof(place));
  }
  if (scene.environment.tone != ToneCurve::kClip) {
    hash.add(&scene.environment.tone, sizeof(scene.environment.tone));
  }
  return hash.value();
}

}  // namespace mirage
