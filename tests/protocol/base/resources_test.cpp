// Resources: programs say which limit leaves them too few threads or too little memory.
#include "protocol/base/resources.h"

#include <gtest/gtest.h>

#include <new>
#include <stdexcept>
#include <system_error>

namespace mirage::test {
namespace {

TEST(Resources, AFewThreadsCanBeStarted) { EXPECT_TRUE(require_threads(4)); }

TEST(Resources, ExceptionsAreToldForWhatTheyMean) {
  EXPECT_EQ(error_of(std::bad_alloc()).id, ErrorId::kResources);
  const std::system_error threads(std::make_error_code(std::errc::resource_unavailable_try_again));
  EXPECT_EQ(error_of(threads).id, ErrorId::kResources);
  EXPECT_EQ(error_of(std::runtime_error("odd")).id, ErrorId::kInternal);
  EXPECT_EQ(error_of(std::runtime_error("odd")).text, "odd");
}

}  // namespace
}  // namespace mirage::test
