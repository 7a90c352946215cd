/// vip-study merge, withdraw and export, from their command lines.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/apps/study_test_support.hpp"

namespace apps::test {
namespace {

using ::testing::HasSubstr;

TEST(StoreCommandsE2e, StationsAreMergedExportedAndWithdrawnFrom) {
  const TemporaryFolder folder;
  const std::string protocol = folder / "short.toml", all = folder / "all.db";
  base::write_file_atomically(protocol, short_protocol("1"));
  const auto call = [](const std::vector<std::string>& arguments) { return Process(arguments).wait(); };
  for (const char* station : {"north", "south"}) {
    const std::string database = folder / (std::string(station) + ".db");
    EXPECT_EQ(call(run_arguments(protocol, database,
                                 {"--clock", "virtual", "--participant", "P01", "--station", station}))
                  .exit_code,
              0);
  }
  const Ended merged = call({vip_study, "merge", folder / "north.db", folder / "south.db", "--into", all});
  EXPECT_EQ(merged.exit_code, 0) << merged.err;
  EXPECT_THAT(merged.out, HasSubstr("2 sessions"));
  const Ended exported = call({vip_study, "export", "--db", all, "--csv", folder / "csv", "--bids",
                               folder / "bids", "--psych-ds", folder / "psych"});
  EXPECT_EQ(exported.exit_code, 0) << exported.err;
  EXPECT_TRUE(fs::exists(folder / "bids" / "participants.tsv"));
  const auto no_input = [] { ::close(STDIN_FILENO); };
  const Ended unconfirmed = Process({vip_study, "withdraw", "P01-north", "--db", all}, no_input).wait();
  EXPECT_NE(unconfirmed.exit_code, 0);
  EXPECT_THAT(unconfirmed.err, HasSubstr("nothing was deleted"));
  EXPECT_EQ(count_in(all, "SELECT count(*) FROM session"), 2);
  const Ended withdrawn = call({vip_study, "withdraw", "P01-north", "--db", all, "--yes"});
  EXPECT_EQ(withdrawn.exit_code, 0) << withdrawn.err;
  EXPECT_THAT(withdrawn.out, HasSubstr((folder / "bids").string()));
  EXPECT_EQ(call({vip_study, "merge", folder / "north.db", "--into", all}).exit_code, 0);
  EXPECT_EQ(count_in(all, "SELECT count(*) FROM session"), 1);
}

}  // namespace
}  // namespace apps::test
