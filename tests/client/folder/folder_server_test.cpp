// Folder server: a client's messages answered from files, and files that are not what they were.
#include "client/folder/folder_server.h"

#include <gtest/gtest.h>

#include <map>

#include "client/folder/frozen_file.h"
#include "tests/support/protocol_samples.h"

namespace mirage::test {
namespace {

/// A folder of one tile and one mesh.
struct SmallFolder {
  std::map<std::string, Bytes> files;
  wire::FrozenTile tile;
  std::string tile_name, mesh_name;
  Bytes opening;

  SmallFolder() {
    wire::TileReplyT reply = sample_tile_reply();
    reply.request_id = 0;
    const Bytes tile_file = encode_message(std::move(reply), sample_tile_payload());
    tile = wire::FrozenTile(frozen_hash(tile_file), static_cast<std::uint32_t>(tile_file.size()), 2,
                            3, -7, 300, 17, 0, 9, 4, 6, 3, 1);
    wire::MeshReplyT mesh_reply = sample_mesh_reply();
    mesh_reply.request_id = 0;
    const Bytes mesh_file = encode_message(std::move(mesh_reply), {9, 8, 7});
    wire::CatalogueT catalogue;
    catalogue.tiles = {tile};
    catalogue.assets = {wire::FrozenAsset(
        frozen_hash(mesh_file), static_cast<std::uint32_t>(mesh_file.size()), 3, 1, false)};
    wire::WelcomeT welcome = sample_welcome();
    welcome.codec = 1;
    const std::uint64_t revision = welcome.revision;
    tile_name = frozen_tile_name(revision, address_of(tile));
    mesh_name = frozen_asset_name(revision, false, 3, 1);
    files = {{tile_name, tile_file}, {mesh_name, mesh_file}};
    opening =
        encode_frozen({encode_message(std::move(catalogue)), encode_message(std::move(welcome)),
                       encode_message(sample_object_page())});
  }
};

wire::RequestBatchT batch_for(const SmallFolder& folder, std::uint32_t id) {
  const wire::FrozenTile& t = folder.tile;
  wire::RequestBatchT batch;
  batch.asks = {wire::Ask(id, t.instance(), t.object(), 1, 0, t.distance_index(), t.view_x(),
                          t.view_y(), t.view_level(), t.distance_level(), t.size_class(),
                          t.channels(), t.phase())};
  batch.mesh_asks = {wire::MeshAsk(id + 1, 3, 1)};
  return batch;
}

class Folder : public ::testing::Test {
 protected:
  void SetUp() override {
    ASSERT_TRUE(server.open(small.opening).ok());
    ask(sample_hello());
    server.take_messages();
  }
  template <typename T>
  void ask(T&& body) {
    const Bytes bytes = encode_message(std::forward<T>(body));
    ASSERT_TRUE(server.ask(bytes.data(), bytes.size()).ok());
  }
  /// Returns the messages, after fetching what is wanted from `files`.
  std::vector<Message> answers(const std::map<std::string, Bytes>& files) {
    for (const std::string& name : server.take_fetches()) {
      ++fetches;
      const auto at = files.find(name);
      server.fetched(name, at == files.end() ? nullptr : &at->second);
    }
    std::vector<Message> out;
    for (const Bytes& bytes : server.take_messages()) {
      out.push_back(decode_message(bytes.data(), bytes.size()).take());
    }
    return out;
  }

  SmallFolder small;
  FolderServer server;
  int fetches = 0;
};

TEST_F(Folder, GreetsWithTheCatalogueBeforeTheWelcome) {
  ask(sample_hello());
  const std::vector<Message> told = answers({});
  ASSERT_GE(told.size(), 3u);
  EXPECT_EQ(told[0].body.type, wire::Body::Catalogue);
  EXPECT_EQ(told[1].body.type, wire::Body::Welcome);
  EXPECT_EQ(told[2].body.type, wire::Body::ObjectPage);
}

TEST_F(Folder, AnswersAsksByTheirNumbers) {
  ask(batch_for(small, 41));
  const std::vector<Message> told = answers(small.files);
  ASSERT_EQ(told.size(), 2u);
  ASSERT_TRUE(told[0].body.AsTileReply());
  EXPECT_EQ(told[0].body.AsTileReply()->request_id, 41u);
  EXPECT_EQ(told[0].payload, sample_tile_payload());
  ASSERT_TRUE(told[1].body.AsMeshReply());
  EXPECT_EQ(told[1].body.AsMeshReply()->request_id, 42u);
}

TEST_F(Folder, RefusesWhatItDoesNotHaveWithoutFetching) {
  wire::RequestBatchT batch = batch_for(small, 1);
  batch.mesh_asks = {wire::MeshAsk(2, 3, 0)};
  batch.asks.clear();
  ask(std::move(batch));
  ask(sample_ground_request());
  ask(sample_reference_request());
  wire::ViewRequestT view = *sample_hello().view;
  ask(std::move(view));
  const std::vector<Message> told = answers(small.files);
  EXPECT_EQ(fetches, 0);
  EXPECT_EQ(told.size(), 4u);
  for (const Message& message : told) EXPECT_EQ(message.body.type, wire::Body::Refused);
}

TEST_F(Folder, ACutOrChangedOrMissingFileIsAHoleAndFetchedOnce) {
  std::map<std::string, Bytes> damaged = small.files;
  damaged[small.tile_name].back() ^= 1;
  damaged.erase(small.mesh_name);
  ask(batch_for(small, 1));
  std::vector<Message> told = answers(damaged);
  int gone = 0, refused = 0;
  for (const Message& message : told) {
    EXPECT_FALSE(message.body.AsTileReply()) << "a wrong picture";
    if (const wire::CatalogueT* page = message.body.AsCatalogue()) {
      for (const wire::FrozenTile& tile : page->tiles) gone += tile.bytes() == 0 ? 1 : 0;
      for (const wire::FrozenAsset& asset : page->assets) gone += asset.bytes() == 0 ? 1 : 0;
    }
    if (message.body.AsRefused()) ++refused;
  }
  EXPECT_EQ(gone, 2);
  EXPECT_EQ(refused, 2);
  EXPECT_EQ(server.take_holes(), (std::vector<std::string>{small.tile_name, small.mesh_name}));
  EXPECT_EQ(fetches, 2);
  ask(batch_for(small, 11));
  told = answers(small.files);  // even if it has come back
  EXPECT_EQ(fetches, 2);
  EXPECT_EQ(told.size(), 2u);
}

TEST_F(Folder, OneFetchServesAllWhoWait) {
  ask(batch_for(small, 1));
  ask(batch_for(small, 11));
  EXPECT_EQ(answers(small.files).size(), 4u);
  EXPECT_EQ(fetches, 2);
}

TEST(FrozenFile, IsReadBackAndRefusedWhereAByteDiffers) {
  const std::vector<Bytes> messages = sample_messages();
  const Bytes file = encode_frozen(messages);
  const Result<std::vector<Bytes>> back = decode_frozen(file);
  ASSERT_TRUE(back.ok());
  EXPECT_EQ(*back, messages);
  for (std::size_t i = 0; i < file.size(); i += 7) {
    if (i >= 16 && i < 24) continue;  // the size of what is compressed, which zstd checks
    Bytes wrong = file;
    wrong[i] ^= 0x10;
    EXPECT_FALSE(decode_frozen(wrong).ok()) << "byte " << i;
  }
  for (const std::size_t size :
       {std::size_t{0}, std::size_t{7}, std::size_t{20}, file.size() - 1}) {
    EXPECT_FALSE(decode_frozen(Bytes(file.begin(), file.begin() + static_cast<long>(size))).ok());
  }
}

TEST(FrozenFile, AMessageThatOpensNothingIsRefused) {
  FolderServer server;
  EXPECT_FALSE(server.open(encode_frozen({encode_message(sample_bye())})).ok());
  EXPECT_FALSE(server.open(encode_frozen({})).ok()) << "no scene";
  EXPECT_FALSE(server.open(encode_frozen({Bytes(40, 7)})).ok());
}

}  // namespace
}  // namespace mirage::test
