// Zip archives: what a reader finds in one. The end-to-end tests open one with another program.
#include "protocol/output/zip.h"

#include <gtest/gtest.h>

#include <cstring>

namespace mirage::test {
namespace {

std::uint32_t number(const Bytes& from, std::size_t at, int bytes) {
  std::uint32_t out = 0;
  for (int b = 0; b < bytes; ++b) out |= std::uint32_t{from[at + b]} << (8 * b);
  return out;
}

// The bytes of the format's documentation; 0xcbf43926 is the checksum that it is tested with.
TEST(Zip, HasTheBytesOfTheFormat) {
  const std::string nine = "123456789";
  const Result<Bytes> zip = stored_zip({{"a", {nine.begin(), nine.end()}}});
  const Bytes expected{
      'P',  'K',  3,    4,   10, 0, 0,  0, 0,  0, 0,   0,   0x21, 0,   0x26, 0x39, 0xf4, 0xcb, 9,
      0,    0,    0,    9,   0,  0, 0,  1, 0,  0, 0,   'a', '1',  '2', '3',  '4',  '5',  '6',  '7',
      '8',  '9',  'P',  'K', 1,  2, 10, 0, 10, 0, 0,   0,   0,    0,   0,    0,    0x21, 0,    0x26,
      0x39, 0xf4, 0xcb, 9,   0,  0, 0,  9, 0,  0, 0,   1,   0,    0,   0,    0,    0,    0,    0,
      0,    0,    0,    0,   0,  0, 0,  0, 0,  0, 'a', 'P', 'K',  5,   6,    0,    0,    0,    0,
      1,    0,    1,    0,   47, 0, 0,  0, 40, 0, 0,   0,   0,    0};
  ASSERT_TRUE(zip);
  EXPECT_EQ(*zip, expected);
}

TEST(Zip, HasEachEntryAsItIs) {
  const std::vector<ZipEntry> entries = {{"a.txt", {'1', '2', '3', '4', '5', '6', '7', '8', '9'}},
                                         {"folder/\xc3\xa4.bin", Bytes(1000, 7)},
                                         {"empty", {}}};
  const Result<Bytes> zip = stored_zip(entries);
  ASSERT_TRUE(zip);
  const std::size_t end = zip->size() - 22;
  ASSERT_EQ(number(*zip, end, 4), 0x06054b50u);
  ASSERT_EQ(number(*zip, end + 10, 2), entries.size());
  std::size_t at = number(*zip, end + 16, 4);
  EXPECT_EQ(at + number(*zip, end + 12, 4), end);
  for (const ZipEntry& entry : entries) {
    ASSERT_EQ(number(*zip, at, 4), 0x02014b50u);
    const std::size_t size = number(*zip, at + 24, 4), name = number(*zip, at + 28, 2);
    EXPECT_EQ(std::string(zip->begin() + at + 46, zip->begin() + at + 46 + name), entry.name);
    ASSERT_EQ(size, entry.bytes.size());
    const std::size_t local = number(*zip, at + 42, 4);
    ASSERT_EQ(number(*zip, local, 4), 0x04034b50u);
    const std::size_t body = local + 30 + name;
    EXPECT_TRUE(std::equal(entry.bytes.begin(), entry.bytes.end(), zip->begin() + body));
    at += 46 + name;
  }
  EXPECT_EQ(*stored_zip(entries), *zip);
}

TEST(Zip, RefusesWhatItCannotCount) {
  const Result<Bytes> many = stored_zip(std::vector<ZipEntry>(65'536));
  ASSERT_FALSE(many);
  EXPECT_EQ(many.error().id, ErrorId::kUsage);
  EXPECT_TRUE(stored_zip(std::vector<ZipEntry>(65'535)));
}

}  // namespace
}  // namespace mirage::test
