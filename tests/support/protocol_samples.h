#pragma once
// One valid message of every kind, with every field set.

#include <memory>
#include <vector>

#include "protocol/base/limits.h"
#include "protocol/codec/codec_id.h"
#include "protocol/impostor/tile.h"
#include "protocol/wire/message.h"

namespace mirage::test {

inline std::unique_ptr<wire::LightingT> sample_lighting() {
  auto lighting = std::make_unique<wire::LightingT>();
  lighting->ambient = std::make_unique<wire::Vec3f>(0.5f, 0.25f, 0.125f);
  lighting->lights.emplace_back(wire::Vec3d(1, 2, 3), wire::Vec3f(4, 5, 6), wire::Vec3f(0, -1, 0),
                                7.0f, 0.875f, 0.75f, std::uint8_t{2});
  return lighting;
}

inline wire::ViewRequestT sample_view_request() {
  wire::ViewRequestT m;
  m.request_id = 31;
  m.lighting_id = 2;
  m.home = true;
  m.eye = std::make_unique<wire::Vec3d>(1, 2, 3);
  m.rotation = std::make_unique<wire::Quat>(1, 0, 0, 0);
  m.fov_y = 1;
  m.width = 64;
  m.height = 36;
  m.time_s = 0.5;
  return m;
}

inline wire::HelloT sample_hello() {
  wire::HelloT m;
  m.version_min = 1;
  m.version_max = 3;
  m.token = "secret";
  m.codecs = {1, 0};
  m.name = "viewer";
  m.view = std::make_unique<wire::ViewRequestT>(sample_view_request());
  return m;
}

inline wire::ViewReplyT sample_view_reply() {
  wire::ViewReplyT m;
  m.request_id = 31;
  m.eye = std::make_unique<wire::Vec3d>(1, 2, 3);
  m.rotation = std::make_unique<wire::Quat>(1, 0, 0, 0);
  m.fov_y = 1;
  m.width = 64;
  m.height = 36;
  m.near_m = 0.5;
  m.far_m = 80;
  m.color_bytes = 2;
  m.instances = {3, 7};
  m.kept = true;
  m.server_us = 1500;
  return m;
}

inline wire::WelcomeT sample_welcome() {
  wire::WelcomeT m;
  m.version = 1;
  m.codec = 1;
  m.revision = 0x1122334455667788;
  m.scene = "scene.glb";
  m.renderer = "llvmpipe";
  m.objects = 10;
  m.instances = 20;
  m.triangles = 3'000'000'000;
  m.lighting = sample_lighting();
  m.sky_zenith = std::make_unique<wire::Vec3f>(0.1f, 0.2f, 0.3f);
  m.sky_horizon = std::make_unique<wire::Vec3f>(0.4f, 0.5f, 0.6f);
  m.sky_nadir = std::make_unique<wire::Vec3f>(0.7f, 0.8f, 0.9f);
  m.home_eye = std::make_unique<wire::Vec3d>(1, 2, 3);
  m.home_target = std::make_unique<wire::Vec3d>(4, 5, 6);
  m.walk_radius_m = 20;
  m.walk_speed_mps = 1.4;
  m.geometry = true;
  m.reference = true;
  m.groups = 5;
  m.roots = 3;
  m.bounds_center = std::make_unique<wire::Vec3d>(7, 8, 9);
  m.bounds_radius = 40;
  m.images = 6;
  m.fog_density = 0.015625f;
  m.shadows = true;
  m.codecs = {1, 3};
  m.tile_us = 5000;
  return m;
}

inline std::unique_ptr<wire::ObjectInfoT> sample_object() {
  auto o = std::make_unique<wire::ObjectInfoT>();
  o->center = std::make_unique<wire::Vec3f>(1, 2, 3);
  o->radius = 2;
  o->box_min = std::make_unique<wire::Vec3f>(0, 1, 2);
  o->box_max = std::make_unique<wire::Vec3f>(2, 3, 4);
  o->mean_color = std::make_unique<wire::Vec3f>(0.5f, 0.5f, 0.5f);
  o->needs = 0x301;
  o->triangles = 4;
  o->lods = {wire::LodInfo(4, 500, 0.001f, 0.0f, 0.0f), wire::LodInfo(2, 300, 0.25f, 0.5f, 0.125f)};
  o->hull_vertices = {{0, 1, 2}, {2, 1, 2}, {0, 3, 2}, {0, 1, 4}};
  o->hull_parallax = {0.5f, 0, 0.25f, 1};
  o->hull_indices = {0, 2, 1, 0, 1, 3, 0, 3, 2, 1, 2, 3};
  o->surrounds = true;
  o->clip_s = 8;
  o->speed.assign(limits::kMotionSegments, 0.75f);
  o->jump.assign(std::size_t{1} << limits::kMaxPhaseLevel, 0.625f);
  o->wrap_jump = 0.375f;
  o->hidden.assign(32, 0x18);
  return o;
}

inline wire::ObjectPageT sample_object_page() {
  wire::ObjectPageT m;
  m.first = 48;
  m.objects.push_back(sample_object());
  m.objects.push_back(sample_object());
  return m;
}

inline wire::InstancePageT sample_instance_page() {
  wire::InstancePageT m;
  m.request_id = 13;
  m.last = true;
  m.opened = {3080};
  m.instances = {
      {wire::Vec3d(1e6, 2, 3), wire::Quat(0.5f, 0.5f, 0.5f, 0.5f), 2.0f, 6, 7, 3080, 0.5f, 2},
      {wire::Vec3d(0, 0, 0), wire::Quat(1, 0, 0, 0), 1.0f, 7, 8, 0xffffffffu, 0.0f, 1}};
  m.groups = {{wire::Vec3d(1e6, 0, -3), wire::Vec3f(2, 1, 0.5f), 0x00804020u, 0x123, 3080,
               0xffffffffu, 6, 2, 1}};
  return m;
}

inline wire::OpenRequestT sample_open_request() {
  wire::OpenRequestT m;
  m.request_id = 13;
  m.groups = {3080, 3081};
  m.eye = std::make_unique<wire::Vec3d>(1, 2, 3);
  m.forward = std::make_unique<wire::Vec3d>(0, 0, -1);
  m.focal_px = 640;
  m.tau_px = 1;
  m.speed_mps = 1.4;
  m.margin = 1.6;
  return m;
}

inline wire::SetLightingT sample_set_lighting() {
  wire::SetLightingT m;
  m.id = 5;
  m.lighting = sample_lighting();
  return m;
}

inline wire::RequestBatchT sample_request_batch() {
  wire::RequestBatchT m;
  m.lighting_id = 5;
  m.asks = {{1, 2, 3, 4.5f, 100, -7, 300, 17, 9, 4, 6, 3, 0},
            {2, 3, 4, 0.5f, 0, 8, 0, 511, 9, 4, 14, 1, 256}};
  m.cancels = {10, 11};
  m.credit_bytes = 0x123456789;
  m.mesh_asks = {wire::MeshAsk(11, 3, 1)};
  m.image_asks = {wire::ImageAsk(12, 5, 2)};
  m.codec = static_cast<std::uint8_t>(TileCodec::kWebp);
  return m;
}

inline wire::ReferenceRequestT sample_reference_request() {
  wire::ReferenceRequestT m;
  m.request_id = 6;
  m.lighting_id = 5;
  m.eye = std::make_unique<wire::Vec3d>(1, 2, 3);
  m.rotation = std::make_unique<wire::Quat>(1.0f, 0.0f, 0.0f, 0.0f);
  m.fov_y = 1.0;
  m.width = 640;
  m.height = 360;
  m.supersample = 2;
  m.time_s = 1.5;
  return m;
}

inline wire::StatsRequestT sample_stats_request() {
  wire::StatsRequestT m;
  m.request_id = 9;
  return m;
}

inline wire::GroundRequestT sample_ground_request() {
  wire::GroundRequestT m;
  m.request_id = 14;
  m.x = -7;
  m.z = 2'000'000'000;
  return m;
}

inline wire::GroundReplyT sample_ground_reply() {
  wire::GroundReplyT m;
  m.request_id = 14;
  m.x = -7;
  m.z = 2'000'000'000;
  m.raw_bytes = 12'304;
  return m;
}

inline wire::CatalogueT sample_catalogue() {
  wire::CatalogueT m;
  m.tiles = {wire::FrozenTile(0x1122334455667788, 4321, 2, 3, -7, 300, 17, 0, 9, 4, 6, 3, 1)};
  m.assets = {wire::FrozenAsset(0x99, 12345, 3, 1, false), wire::FrozenAsset(0x98, 77, 5, 2, true)};
  return m;
}

inline wire::TileReplyT sample_tile_reply() {
  wire::TileReplyT m;
  m.request_id = 1;
  m.key_low = 0x0102030405060708;
  m.key_high = 0x1112131415161718;
  m.content_hash = 0x2122232425262728;
  m.edge = 64;
  m.crop_x = 1;
  m.crop_y = 2;
  m.crop_w = 1;
  m.crop_h = 2;
  m.codec = static_cast<std::uint8_t>(TileCodec::kZstd);
  m.plane_depth = 1;
  m.depth_min = 0.5f;
  m.depth_max = 1.5f;
  m.dz_quad = 0.25f;
  m.dz_cuboid = 0.125f;
  m.dz_hull = 0.0625f;
  m.depth_gap = 0.75f;
  m.dz_behind = 0.375f;
  m.lod_error = 0.03125f;
  m.queue_us = 10;
  m.render_us = 20;
  m.encode_us = 30;
  m.channels = kRelitTile;
  m.color_rms = 1.25f;
  m.color_max = 6;
  m.server_us = 40;
  return m;
}

/// Returns colour, surface and depth of two texels, in a stored zstd frame.
inline Bytes sample_tile_payload() {
  return {0x28, 0xb5, 0x2f, 0xfd, 0x20, 18, 18 << 3 | 1, 0,  0,  //
          1,    2,    3,    4,    5,    6,  7,           8,  9,  //
          10,   11,   12,   13,   14,   15, 16,          17, 18};
}

inline wire::RefusedT sample_refused() {
  wire::RefusedT m;
  m.request_id = 4;
  m.reason = wire::RefusalReason::Late;
  return m;
}

inline wire::MeshReplyT sample_mesh_reply() {
  wire::MeshReplyT m;
  m.request_id = 11;
  m.object = 3;
  m.lod = 1;
  m.raw_bytes = 1000;
  return m;
}

inline wire::ImageReplyT sample_image_reply() {
  wire::ImageReplyT m;
  m.request_id = 12;
  m.image = 5;
  m.level = 2;
  return m;
}

inline wire::ImagePageT sample_image_page() {
  wire::ImagePageT m;
  m.first = 4096;
  m.images = {wire::ImageInfo(640, 480, 0x80402010u, 0.5f, true),
              wire::ImageInfo(1, 1, 0u, 0.0f, false)};
  return m;
}

inline wire::LightProbePageT sample_probe_page() {
  wire::LightProbePageT m;
  m.id = 0x8877665544332211ull;
  for (int i = 0; i < 27; ++i) m.irradiance.push_back(0.125f * static_cast<float>(i - 4));
  return m;
}

inline wire::ReferenceReplyT sample_reference_reply() {
  wire::ReferenceReplyT m;
  m.request_id = 6;
  m.width = 2;
  m.height = 1;
  m.raw_bytes = 8;
  m.render_us = 99;
  return m;
}

inline wire::StatsT sample_stats() {
  wire::StatsT m;
  m.request_id = 9;
  m.tiles_rendered = 1;
  m.tiles_merged = 2;
  m.store_hits = 3;
  m.store_bytes = 4;
  m.tiles_cancelled = 5;
  m.tiles_late = 6;
  m.queue_length = 7;
  m.clients = 8;
  return m;
}

inline wire::ByeT sample_bye() {
  wire::ByeT m;
  m.error = "wire-limit";
  m.text = "too much";
  return m;
}

inline std::vector<Bytes> sample_messages() {
  return {encode_message(sample_hello()),
          encode_message(sample_welcome()),
          encode_message(sample_object_page()),
          encode_message(sample_instance_page()),
          encode_message(sample_set_lighting()),
          encode_message(sample_request_batch()),
          encode_message(sample_reference_request()),
          encode_message(sample_stats_request()),
          encode_message(sample_tile_reply(), sample_tile_payload()),
          encode_message(sample_refused()),
          encode_message(sample_mesh_reply(), {9, 8, 7}),
          encode_message(sample_reference_reply(), {1, 2, 3}),
          encode_message(sample_stats()),
          encode_message(sample_bye()),
          encode_message(sample_image_page()),
          encode_message(sample_image_reply(), {6, 5}),
          encode_message(sample_open_request()),
          encode_message(sample_probe_page(), {5, 4, 3}),
          encode_message(sample_view_request()),
          encode_message(sample_view_reply(), {4, 3, 2}),
          encode_message(sample_ground_request()),
          encode_message(sample_ground_reply(), {3, 2, 1}),
          encode_message(sample_catalogue())};
}

}  // namespace mirage::test
