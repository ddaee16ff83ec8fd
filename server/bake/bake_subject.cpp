#include "server/bake/bake_subject.h"

#include <algorithm>
#include <cmath>
#include <set>

#include "server/bake/export.h"
#include "server/prepare/prepared_scene.h"

namespace mirage {
namespace {

constexpr std::size_t kNamesInHint = 12;

glm::dvec3 placed(const Similarity& at, const glm::vec3& p) {
  return at.position + glm::dquat(at.rotation) * (double{at.scale} * glm::dvec3(p));
}

template <typename Use>
void each_vertex(const PreparedScene& scene, const BakeSubject& subject, const Use& use) {
  for (const SubjectPart& part : subject.parts) {
    for (const Vertex& vertex : scene.scene.objects[part.object].mesh.vertices) {
      use(placed(part.placed, vertex.position));
    }
  }
}

void measure(const PreparedScene& scene, BakeSubject& subject) {
  glm::dvec3 low(1e300), high(-1e300);
  each_vertex(scene, subject, [&](const glm::dvec3& p) {
    low = glm::min(low, p);
    high = glm::max(high, p);
  });
  if (low.x > high.x) return;  // no vertices
  subject.center = (low + high) / 2.0;
  subject.extent = high - low;
  double most = 0;
  each_vertex(scene, subject, [&](const glm::dvec3& p) {
    const glm::dvec3 d = p - subject.center;
    most = std::max(most, glm::dot(d, d));
  });
  subject.radius = std::sqrt(most);
  for (const SubjectPart& part : subject.parts) {
    const SceneObject& object = scene.scene.objects[part.object];
    subject.triangles += object.mesh.indices.size() / 3;
    subject.animated |= object.animation != nullptr;
    subject.blended |= (scene.objects[part.object].needs & kNeedBlend) != 0;
  }
}

BakeSubject one_object(const PreparedScene& scene, std::uint32_t object) {
  BakeSubject out;
  out.name = scene.scene.objects[object].name;
  Similarity placed;
  for (const Instance& instance : scene.scene.instances) {
    if (instance.object != object) continue;
    placed = instance.world_from_object;
    break;
  }
  placed.position = glm::dvec3(0);
  out.parts = {{object, placed}};
  return out;
}

bool wanted(const SubjectChoice& choice, std::uint32_t object, const std::string& name,
            std::vector<bool>& used) {
  if (choice.names.empty()) return true;
  bool any = false;
  for (std::size_t i = 0; i < choice.names.size(); ++i) {
    if (choice.names[i] != std::to_string(object) && !fits_glob(choice.names[i], name)) continue;
    used[i] = any = true;
  }
  return any;
}

Error no_such(const PreparedScene& scene, const std::string& name) {
  std::string known;
  for (std::size_t i = 0; i < scene.scene.objects.size() && i < kNamesInHint; ++i) {
    known += (i ? ", " : "") + std::to_string(i) + " '" + scene.scene.objects[i].name + "'";
  }
  if (scene.scene.objects.size() > kNamesInHint) known += ", ...";
  return make_error(ErrorId::kUsage, "no object is called '" + name + "'",
                    "objects: " + known + "; * and ? stand for any characters");
}

void make_names_differ(std::vector<BakeSubject>& subjects) {
  std::set<std::string> taken;
  for (BakeSubject& subject : subjects) {
    const std::string plain = file_name_of(subject.name);
    std::string name = plain;
    for (int i = 2; !taken.insert(name).second; ++i) name = plain + "-" + std::to_string(i);
    subject.name = name;
  }
}

}  // namespace

bool fits_glob(const std::string& pattern, const std::string& text) {
  // `star` is the last * met; on a mismatch it takes one character more.
  std::size_t p = 0, t = 0, star = std::string::npos, taken = 0;
  while (t < text.size()) {
    if (p < pattern.size() && (pattern[p] == '?' || pattern[p] == text[t]) && pattern[p] != '*') {
      ++p, ++t;
    } else if (p < pattern.size() && pattern[p] == '*') {
      star = p++;
      taken = t;
    } else if (star != std::string::npos) {
      p = star + 1;
      t = ++taken;
    } else {
      return false;
    }
  }
  while (p < pattern.size() && pattern[p] == '*') ++p;
  return p == pattern.size();
}

Result<std::vector<BakeSubject>> bake_subjects(const PreparedScene& scene,
                                               const SubjectChoice& choice) {
  std::vector<BakeSubject> out;
  if (choice.whole) {
    BakeSubject all;
    all.name = choice.whole_name;
    for (const Instance& instance : scene.scene.instances) {
      all.parts.push_back({instance.object, instance.world_from_object});
    }
    out.push_back(std::move(all));
  } else {
    std::vector<bool> used(choice.names.size(), false);
    for (std::uint32_t i = 0; i < scene.scene.objects.size(); ++i) {
      if (wanted(choice, i, scene.scene.objects[i].name, used)) out.push_back(one_object(scene, i));
    }
    for (std::size_t i = 0; i < used.size(); ++i) {
      if (!used[i]) return no_such(scene, choice.names[i]);
    }
  }
  for (BakeSubject& subject : out) measure(scene, subject);
  make_names_differ(out);
  return out;
}

}  // namespace mirage
