// Unpacking by a link: afterwards the payload is what decoding the message would have given.
#include "protocol/wire/unpack.h"

#include <gtest/gtest.h>

#include "protocol/codec/image_codec.h"
#include "protocol/codec/mip_chain.h"
#include "protocol/codec/tile_codec.h"
#include "protocol/wire/conversions.h"
#include "protocol/wire/view_codec.h"
#include "tests/support/protocol_samples.h"

namespace mirage::test {
namespace {

Tile some_tile() {
  Tile tile;
  tile.edge = 64;
  tile.crop = {3, 5, 40, 30};
  for (std::size_t i = 0; i < tile.crop.area(); ++i) {
    const auto alpha = static_cast<std::uint8_t>(i % 7 == 0 ? 0 : 255);
    for (std::size_t c = 0; c < 3; ++c) {
      tile.rgba.push_back(alpha == 0 ? std::uint8_t{0}
                                     : static_cast<std::uint8_t>(i / 40 + 60 * c));
    }
    tile.rgba.push_back(alpha);
    tile.depth.push_back(static_cast<std::uint8_t>(i % 251));
  }
  return tile;
}

template <typename BodyT>
Message message_of(BodyT body, Bytes payload) {
  Message message;
  message.body.Set(std::move(body));
  message.payload_bytes = payload.size();
  message.payload = std::move(payload);
  return message;
}

Message tile_reply(const Tile& tile, TileCodec codec) {
  wire::TileReplyT reply;
  set_tile_fields(tile, reply);
  reply.codec = static_cast<std::uint8_t>(codec);
  return message_of(std::move(reply), encode_tile_planes(tile, codec));
}

TEST(ProtocolUnpack, TilesBecomeTheRawPlanesTheirCodecDecodesTo) {
  const Tile tile = some_tile();
  for (const TileCodec codec : kTileCodecs) {
    Message message = tile_reply(tile, codec);
    const Bytes packed = message.payload;
    ASSERT_TRUE(MessageUnpacker().unpack(message)) << codec_name(codec);
    EXPECT_TRUE(message.unpacked);
    EXPECT_EQ(message.payload_bytes, packed.size()) << "as it came";
    Tile direct = *tile_from_fields(*message.body.AsTileReply());
    ASSERT_TRUE(decode_tile_planes(packed.data(), packed.size(), codec, direct));
    Result<UnpackedTile> back = read_unpacked_tile(message);
    ASSERT_TRUE(back) << codec_name(codec);
    EXPECT_EQ(back->tile.rgba, direct.rgba) << codec_name(codec);
    EXPECT_EQ(back->tile.depth, direct.depth) << codec_name(codec);
    EXPECT_EQ(back->planes.color, atlas_planes(direct).color) << codec_name(codec);
    EXPECT_EQ(back->planes.depth, atlas_planes(direct).depth) << codec_name(codec);
    message.payload.pop_back();
    EXPECT_FALSE(read_unpacked_tile(message)) << "a byte is missing";
  }
}

TEST(ProtocolUnpack, ImagesBecomeTexels) {
  Image image{24, 16, true, Bytes(24 * 16 * 4)};
  for (std::size_t i = 0; i < image.rgba.size(); ++i) {
    image.rgba[i] = static_cast<std::uint8_t>(i * 37);
  }
  Message message = message_of(wire::ImageReplyT(), *encode_image(image));
  ASSERT_TRUE(MessageUnpacker().unpack(message));
  EXPECT_EQ(message.payload, image.rgba) << "small ones come without loss";
}

TEST(ProtocolUnpack, ImagesOfAlphaTestsBringMipsThatKeepCoverage) {
  Image image{24, 16, false, Bytes(24 * 16 * 4)};
  for (std::size_t i = 0; i < image.rgba.size(); ++i) {
    image.rgba[i] = static_cast<std::uint8_t>(i * 37);
  }
  wire::ImagePageT page;
  page.first = 3;
  page.images.emplace_back(24, 16, 0, 0.5f, false);
  wire::ImageReplyT reply;
  reply.image = 3;
  MessageUnpacker unpacker;
  Message told = message_of(std::move(page), {});
  Message message = message_of(std::move(reply), *encode_image(image));
  ASSERT_TRUE(unpacker.unpack(told));
  ASSERT_TRUE(unpacker.unpack(message));
  const glm::uvec2 size(24, 16);
  const Result<std::vector<Image>> levels = read_unpacked_image(message.payload, size, false, true);
  ASSERT_TRUE(levels);
  const std::vector<Image> mips = alpha_preserving_mips(image, 0.5f);
  ASSERT_EQ(levels->size(), 1 + mips.size());
  EXPECT_EQ((*levels)[0].rgba, image.rgba);
  for (std::size_t i = 0; i < mips.size(); ++i) EXPECT_EQ((*levels)[i + 1].rgba, mips[i].rgba);
  EXPECT_FALSE(read_unpacked_image(message.payload, size, false, false)) << "more than one level";
  EXPECT_FALSE(read_unpacked_image(image.rgba, size, false, true)) << "the mip levels are missing";
  EXPECT_FALSE(read_unpacked_image({}, size, false, false));
}

TEST(ProtocolUnpack, ViewsBecomeWhatDecodingGives) {
  ViewTile view;
  view.camera.width = 64;
  view.camera.height = 36;
  view.rgba.assign(64 * 36 * 4, 90);
  view.instances = {3, 7};
  for (std::uint32_t i = 0; i < view.columns() * view.rows(); ++i) {
    view.depth.push_back(static_cast<std::uint8_t>(1 + i % 200));
    view.owners.push_back(static_cast<std::uint16_t>(i % 3));
  }
  EncodedView encoded = encode_view(view);
  const ViewTile direct = *decode_view(encoded.reply, encoded.payload);
  Message message = message_of(std::move(encoded.reply), encoded.payload);
  ASSERT_TRUE(MessageUnpacker().unpack(message));
  const ViewTile back = *view_of_planes(*message.body.AsViewReply(), message.payload);
  EXPECT_EQ(back.rgba, direct.rgba);
  EXPECT_EQ(back.depth, view.depth);
  EXPECT_EQ(back.owners, view.owners);
  message.payload.pop_back();
  EXPECT_FALSE(view_of_planes(*message.body.AsViewReply(), message.payload)) << "a byte is missing";
}

TEST(ProtocolUnpack, BlocksAreDecompressedWithinLimits) {
  const Bytes raw(5000, 7);
  wire::MeshReplyT mesh;
  mesh.raw_bytes = 5000;
  Message message = message_of(wire::MeshReplyT(mesh), compress_block(raw.data(), raw.size()));
  ASSERT_TRUE(MessageUnpacker().unpack(message));
  EXPECT_EQ(message.payload, raw);
  mesh.raw_bytes = 4'000'000'000;
  Message bomb = message_of(wire::MeshReplyT(mesh), compress_block(raw.data(), raw.size()));
  const Result<void> taken = MessageUnpacker().unpack(bomb);
  ASSERT_FALSE(taken);
  EXPECT_EQ(taken.error().id, ErrorId::kWireLimit) << "refused before it is looked into";
}

TEST(ProtocolUnpack, DamageIsAnErrorAndOthersStayAsTheyAre) {
  for (const TileCodec codec : kTileCodecs) {
    Message cut = tile_reply(some_tile(), codec);
    cut.payload.resize(cut.payload.size() / 2);
    EXPECT_FALSE(MessageUnpacker().unpack(cut)) << codec_name(codec);
  }
  Message image = message_of(wire::ImageReplyT(), Bytes(40, 1));
  EXPECT_FALSE(MessageUnpacker().unpack(image));
  Message welcome = message_of(sample_welcome(), Bytes{1, 2, 3});
  ASSERT_TRUE(MessageUnpacker().unpack(welcome));
  EXPECT_EQ(welcome.payload, (Bytes{1, 2, 3}));
}

}  // namespace
}  // namespace mirage::test
