#include "libstudy/protocol/find_protocol.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>

#include "stats/base/error.hpp"
#include "stats/base/file.hpp"

namespace {

using ::testing::HasSubstr;

TEST(FindProtocol, ByPathByShippedPathAndByName) {
  const auto shipped_file = base::resource("protocols/task1.toml");
  for (const char* named : {"task1", "task1.toml", "protocols/task1.toml"})
    EXPECT_TRUE(std::filesystem::equivalent(study::find_protocol(named), shipped_file)) << named;
  EXPECT_EQ(study::find_protocol(shipped_file), shipped_file);
  EXPECT_THAT([] { study::find_protocol("tsk1"); },
              testing::ThrowsMessage<base::Error>(testing::AllOf(HasSubstr("is neither a file nor the name"),
                                                                 HasSubstr("the nearest is \"task1\""))));
  EXPECT_THROW(study::find_protocol("no/such/task1"), base::Error);
}

}  // namespace
