// Admission: whether a client may connect, by its address and by the origin of a browser's page.
#include "server/net/admission.h"

#include <gtest/gtest.h>

namespace mirage::test {
namespace {

TEST(Admission, TenWrongHellosASecondAreTooMany) {
  Admission admission;
  for (int i = 0; i < 9; ++i) admission.note_failure("a", i * 1000);
  EXPECT_TRUE(admission.may_connect("a", 10'000));
  admission.note_failure("a", 10'000);
  EXPECT_FALSE(admission.may_connect("a", 20'000));
  EXPECT_TRUE(admission.may_connect("b", 20'000)) << "another address";
  EXPECT_FALSE(admission.may_connect("a", 1'000'000));
  EXPECT_TRUE(admission.may_connect("a", 1'001'000)) << "the first is a second ago";
}

TEST(Admission, ManyAddressesDoNotGrowWithoutEnd) {
  Admission admission;
  for (int i = 0; i < 100'000; ++i) admission.note_failure(std::to_string(i), 0);
  EXPECT_TRUE(admission.may_connect("0", 0));
}

TEST(SameOrigin, IsTheHostThatIsAsked) {
  EXPECT_TRUE(same_origin("http://box:9870", "box:9870", false));
  EXPECT_TRUE(same_origin("http://BOX:9870", "box:9870", false));
  EXPECT_TRUE(same_origin("https://box", "box:443", true));
  EXPECT_TRUE(same_origin("http://box:80", "box", false));
  EXPECT_FALSE(same_origin("https://box:9870", "box:9870", false));
  EXPECT_FALSE(same_origin("http://box:9871", "box:9870", false));
  EXPECT_FALSE(same_origin("http://box.evil.example", "box", false));
  EXPECT_FALSE(same_origin("null", "box", false));
  EXPECT_FALSE(same_origin("http://", "", false));
  EXPECT_FALSE(same_origin("", "", false));
}

}  // namespace
}  // namespace mirage::test
