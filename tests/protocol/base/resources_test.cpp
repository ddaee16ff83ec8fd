// Resources: programs say which limit leaves them too few threads or too little memory.
#include "protocol/base/resources.h"

#include <gtest/gtest.h>
#include <sys/resource.h>

#include <new>
#include <stdexcept>
#include <system_error>

namespace mirage::test {
namespace {

TEST(Resources, AFewThreadsCanBeStarted) { EXPECT_TRUE(require_threads(4)); }

TEST(Resources, MemoryIsAtMostWhatIsLimited) {
  rlimit before{};
  ASSERT_EQ(getrlimit(RLIMIT_AS, &before), 0);
  const std::uint64_t free = memory_bytes();
  rlimit least = before;
  least.rlim_cur = 3ull << 29;  // 1.5 GB: this test goes on to need a little
  if (free <= least.rlim_cur || setrlimit(RLIMIT_AS, &least) != 0) GTEST_SKIP() << "little memory";
  EXPECT_EQ(memory_bytes(), least.rlim_cur);
  setrlimit(RLIMIT_AS, &before);
  EXPECT_EQ(memory_bytes(), free);
}

TEST(Resources, ExceptionsAreToldForWhatTheyMean) {
  EXPECT_EQ(error_of(std::bad_alloc()).id, ErrorId::kResources);
  const std::system_error threads(std::make_error_code(std::errc::resource_unavailable_try_again));
  EXPECT_EQ(error_of(threads).id, ErrorId::kResources);
  EXPECT_EQ(error_of(std::runtime_error("odd")).id, ErrorId::kInternal);
  EXPECT_EQ(error_of(std::runtime_error("odd")).text, "odd");
}

}  // namespace
}  // namespace mirage::test
