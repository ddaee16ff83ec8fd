#include "client/freeze/opening.h"

#include <algorithm>
#include <iterator>
#include <map>
#include <set>
#include <utility>

#include "protocol/base/limits.h"
#include "protocol/codec/codec_id.h"

namespace mirage {
namespace {

constexpr std::uint32_t kNoGroup = 0xffffffffu;

/// Members of groups, as pages have told them.
struct Tree {
  std::map<std::uint32_t, wire::InstanceRecord> instances;  ///< by id
  std::map<std::uint32_t, wire::GroupRecord> groups;
  std::set<std::uint32_t> opened;

  void add(const wire::InstancePageT& page) {
    for (const wire::InstanceRecord& i : page.instances) instances.emplace(i.id(), i);
    for (const wire::GroupRecord& g : page.groups) groups.emplace(g.id(), g);
    opened.insert(page.opened.begin(), page.opened.end());
  }
};

// A page holds all members of a group, and comes after the page that tells the group. Groups have
// smaller numbers than those nested in them; instances with parts have none nested in them.
std::vector<wire::InstancePageT> pages_of(const Tree& tree, std::uint32_t all_instances) {
  std::map<std::uint32_t, wire::InstancePageT> by_parent;
  for (const auto& [id, record] : tree.instances) {
    by_parent[record.parent()].instances.push_back(record);
  }
  for (const auto& [id, record] : tree.groups) by_parent[record.parent()].groups.push_back(record);
  for (const std::uint32_t id : tree.opened) by_parent[id].opened.push_back(id);
  std::vector<std::uint32_t> order;
  if (by_parent.count(kNoGroup) != 0) order.push_back(kNoGroup);
  for (const bool groups : {true, false}) {
    for (const auto& [parent, page] : by_parent) {
      if (parent != kNoGroup && (parent >= all_instances) == groups) order.push_back(parent);
    }
  }
  std::vector<wire::InstancePageT> out;
  const auto fits = [](const wire::InstancePageT& a, const wire::InstancePageT& b) {
    return a.instances.size() + b.instances.size() <= limits::kInstancesPerPage &&
           a.groups.size() + b.groups.size() <= limits::kInstancesPerPage &&
           a.opened.size() + b.opened.size() <= limits::kInstancesPerPage;
  };
  const auto append = [](auto& to, const auto& from) {
    to.insert(to.end(), from.begin(), from.end());
  };
  bool told_parts = false;
  for (const std::uint32_t parent : order) {
    // Members without a parent may be more than a page holds; they need not be in one.
    wire::InstancePageT& page = by_parent[parent];
    for (std::size_t i = 0; parent == kNoGroup && i < page.instances.size();
         i += limits::kInstancesPerPage) {
      const std::size_t end = std::min(page.instances.size(), i + limits::kInstancesPerPage);
      wire::InstancePageT& part = out.emplace_back();
      part.instances.assign(page.instances.begin() + static_cast<std::ptrdiff_t>(i),
                            page.instances.begin() + static_cast<std::ptrdiff_t>(end));
    }
    if (parent == kNoGroup) page.instances.clear();
    // An instance has to be known before a page tells its parts.
    const bool parts = parent < all_instances;
    const bool first_parts = parts && !std::exchange(told_parts, true);
    if (out.empty() || first_parts || !fits(out.back(), page)) out.emplace_back();
    append(out.back().instances, page.instances);
    append(out.back().groups, page.groups);
    append(out.back().opened, page.opened);
  }
  if (out.empty()) out.emplace_back();
  out.back().last = true;
  return out;
}

std::vector<Bytes> catalogue_of(const Kept& kept) {
  std::vector<wire::CatalogueT> pages(1);
  for (const auto& [name, entry] : kept.files) {
    wire::CatalogueT& page = pages.back();
    if (entry.is_tile) {
      page.tiles.push_back(entry.tile);
    } else {
      page.assets.push_back(entry.asset);
    }
    const bool full =
        page.tiles.size() == limits::kFrozenPerPage || page.assets.size() == limits::kFrozenPerPage;
    if (full) pages.emplace_back();
  }
  std::vector<Bytes> out;
  for (wire::CatalogueT& page : pages) out.push_back(encode_message(std::move(page)));
  return out;
}

/// The part of the scene that is kept as geometry.
struct Geometry {
  std::set<std::uint32_t> objects;
  TileCodec codec = TileCodec::kZstd;
};

Geometry geometry_of(const Kept& kept) {
  Geometry out;
  for (const auto& [name, entry] : kept.files) {
    if (entry.is_tile) out.codec = static_cast<TileCodec>(entry.tile.codec());
    if (!entry.is_tile && !entry.asset.image()) out.objects.insert(entry.asset.index());
  }
  return out;
}

void strip(wire::WelcomeT& welcome, const Geometry& geometry) {
  welcome.reference = false;
  welcome.geometry = !geometry.objects.empty();
  welcome.codec = static_cast<std::uint8_t>(geometry.codec);
  welcome.codecs = {welcome.codec};
  welcome.tile_us = 0;
  welcome.walk_eye_m = 0;
  welcome.clips.clear();
  welcome.variants.clear();
}

void strip(wire::ObjectPageT& page, const Geometry& geometry) {
  for (std::size_t i = 0; i < page.objects.size(); ++i) {
    const auto object = static_cast<std::uint32_t>(page.first + i);
    if (geometry.objects.count(object) == 0) page.objects[i]->lods.clear();
  }
}

}  // namespace

Result<std::vector<Bytes>> opening_of(const FrozenPart& part, const Kept& kept) {
  const Geometry geometry = geometry_of(kept);
  Tree tree;
  std::vector<Bytes> out = catalogue_of(kept);
  std::uint32_t all_instances = 0;
  std::vector<Bytes> told = part.opening;
  told.insert(told.end(), part.pages.begin(), part.pages.end());
  for (const Bytes& bytes : told) {
    Result<Message> message = decode_message(bytes.data(), bytes.size());
    if (!message) return message.error();
    wire::BodyUnion& body = message->body;
    if (wire::InstancePageT* page = body.AsInstancePage()) {
      tree.add(*page);
      continue;
    }
    if (wire::WelcomeT* welcome = body.AsWelcome()) {
      all_instances = welcome->instances;
      strip(*welcome, geometry);
    }
    if (wire::ObjectPageT* page = body.AsObjectPage()) strip(*page, geometry);
    out.push_back(encode_body(body, message->payload));
  }
  for (wire::InstancePageT& page : pages_of(tree, all_instances)) {
    out.push_back(encode_message(std::move(page)));
  }
  if (part.view.empty()) return out;
  Result<Message> view = decode_message(part.view.data(), part.view.size());
  if (!view) return view.error();
  view->body.AsViewReply()->request_id = view->body.AsViewReply()->server_us = 0;
  view->body.AsViewReply()->kept = true;
  out.push_back(encode_body(view->body, view->payload));
  return out;
}

}  // namespace mirage
