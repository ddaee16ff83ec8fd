// Views as people write them.
#include "protocol/model/view_place.h"

#include <gtest/gtest.h>

namespace mirage::test {
namespace {

TEST(ViewPlace, IsReadAndWritten) {
  const Result<ViewPlace> place = parse_view_place("1,-2.5,3e2,0,0.1,0");
  ASSERT_TRUE(place);
  EXPECT_EQ(place->eye, glm::dvec3(1, -2.5, 300));
  EXPECT_EQ(place->target, glm::dvec3(0, 0.1, 0));
  const Result<ViewPlace> again = parse_view_place(to_text(*place));
  ASSERT_TRUE(again);
  EXPECT_EQ(again->eye, place->eye);
  EXPECT_EQ(again->target, place->target);
}

TEST(ViewPlace, RefusesWhatIsNone) {
  for (const char* text : {"", "1,2,3", "1,2,3,4,5", "1,2,3,4,5,6,7", "1,2,3,4,5,6x", "a,b,c,d,e,f",
                           "nan,0,0,1,1,1", "inf,0,0,1,1,1", "1e300,0,0,1,1,1", "1,2,3,1,2,3"}) {
    const Result<ViewPlace> place = parse_view_place(text);
    ASSERT_FALSE(place) << text;
    EXPECT_EQ(place.error().id, ErrorId::kUsage);
  }
}

}  // namespace
}  // namespace mirage::test
