// Access: which clients are let in. Tokens from a file and signed ones, each with an end and a
// scope.
#include "server/session/access.h"

#include <gtest/gtest.h>

namespace mirage::test {
namespace {

constexpr std::int64_t kNow = 1'800'000'000;  // January 2027
const std::string kKey = "0123456789abcdef0123456789abcdef";

TEST(Access, WithoutTokensEverybodyMay) {
  const Access none;
  EXPECT_TRUE(none.open());
  EXPECT_TRUE(none.check("", kNow));
  EXPECT_FALSE(Access::parse(""));
  EXPECT_FALSE(Access::parse("# nothing but words\n\n"));
  EXPECT_FALSE(Access::read("/nonexistent"));
}

TEST(Access, ALineIsAToken) {
  const Access access = Access::parse("secret\nother name=anna scope=view  # hers\n").take();
  EXPECT_TRUE(access.check("secret", kNow));
  const Result<Grant> anna = access.check("other", kNow);
  ASSERT_TRUE(anna);
  EXPECT_EQ(anna->name, "anna");
  EXPECT_FALSE(anna->geometry || anna->reference);
  for (const char* wrong : {"", "secre", "secrets", "SECRET", "other name=anna scope=view", "#"}) {
    const Result<Grant> told = access.check(wrong, kNow);
    ASSERT_FALSE(told) << wrong;
    EXPECT_EQ(told.error().id, ErrorId::kAuth);
  }
}

TEST(Access, TokensEnd) {
  const Access access =
      Access::parse("a expires=2027-01-15T08:00:00Z\nb expires=2027-01-15T08:00:01Z").take();
  EXPECT_FALSE(access.check("a", kNow));
  EXPECT_TRUE(access.check("b", kNow));
  EXPECT_FALSE(access.check("b", kNow + 1));
}

TEST(Access, WrongLinesAreNamed) {
  for (const char* line : {"a expires=tomorrow", "a scope=everything", "a scope=geometry",
                           "a nam=b", "a name=b.c", "key=short", "a expires=2027-01-15"}) {
    const Result<Access> told = Access::parse(std::string("good\n") + line + "\n");
    ASSERT_FALSE(told) << line;
    EXPECT_NE(told.error().text.find("line 2"), std::string::npos) << told.error().text;
  }
}

TEST(Access, SignedTokensAreTakenForAWhile) {
  const Access access = Access::parse("key=" + kKey + "\n").take();
  EXPECT_FALSE(access.open());
  const std::string token = signed_token(kKey, "anna", kNow + 10, "view,geometry").take();
  const Result<Grant> anna = access.check(token, kNow);
  ASSERT_TRUE(anna);
  EXPECT_EQ(anna->name, "anna");
  EXPECT_TRUE(anna->geometry);
  EXPECT_FALSE(anna->reference);
  EXPECT_FALSE(access.check(token, kNow + 10)) << "it has ended";
  EXPECT_FALSE(access.check(signed_token(kKey + "x", "anna", kNow + 10, "view").take(), kNow));
  // No character may be changed.
  for (std::size_t i = 0; i < token.size(); ++i) {
    std::string changed = token;
    changed[i] = changed[i] == '1' ? '2' : '1';
    EXPECT_FALSE(access.check(changed, kNow)) << changed;
    EXPECT_FALSE(access.check(token.substr(0, i), kNow));
  }
  EXPECT_FALSE(signed_token(kKey, "an.na", kNow, "view"));
  EXPECT_FALSE(signed_token(kKey, "anna", kNow, "reference"));
}

}  // namespace
}  // namespace mirage::test
