/// The summary at the end of a session reports what the database holds.
#include "libstudy/store/read/session_counts.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/libstudy/session_fixture.hpp"

namespace study {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::StartsWith;

TEST(SessionCounts, AreThoseOfTheTables) {
  test::OneSession session(test::paced_pairs());
  session.run(test::wish_at_frame_5(CutCause::Experimenter, 1));
  const SessionCounts counts = count_session(session.folder / "study.db", 1);
  EXPECT_EQ(counts.participant, "P01");
  EXPECT_EQ(counts.state, "done");
  EXPECT_EQ(counts.done, counts.units);
  EXPECT_EQ(counts.answered, counts.trials);
  EXPECT_EQ(counts.cut, 1);
  EXPECT_EQ(counts.showings, session.count("presentation"));
  EXPECT_EQ(counts.answers, session.count("response"));
  EXPECT_EQ(counts.frames, session.count("frame"));
  EXPECT_EQ(counts.pass + counts.degraded + counts.fail,
            session.count("presentation WHERE verdict IS NOT NULL"));
  EXPECT_THAT(summary_of(counts), AllOf(StartsWith("P01: done; "), HasSubstr("1 cut short"),
                                        HasSubstr(std::to_string(counts.frames) + " frames")));
  EXPECT_EQ(count_session(session.folder / "study.db", 9).participant, "");
}

}  // namespace
}  // namespace study
