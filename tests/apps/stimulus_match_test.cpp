/// Whether a bake shows the stimulus that the protocol names. Data of another stimulus are test data.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/apps/study_test_support.hpp"

namespace apps::test {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::Not;

class StimulusMatchE2e : public ::testing::Test {
 protected:
  StimulusMatchE2e() {
    const std::string scene = base::read_file(base::resource("data/scenes/single_dam.toml"), 1 << 20);
    base::write_file_atomically(scene_, replaced(scene, "settle_frames = 120", "settle_frames = 1"));
    const Ended baked = run_program({vip_study, "bake", scene_, "--method", "LoRes", "--n-star", "64",
                                     "--backend", "cpu", "--frames", "5", "--out", bake_});
    EXPECT_EQ(baked.exit_code, 0) << baked.err;
  }
  /// A session under a protocol that names `scene`, `method` and `n_star`.
  Ended run(const std::string& scene, const std::string& method, const std::string& n_star) {
    base::write_file_atomically(protocol_,
                                with_keys(short_protocol("1"), {{"scene", "[\"" + scene + "\"]"},
                                                                {"method", "[\"" + method + "\"]"},
                                                                {"n_star", "[\"" + n_star + "\"]"}}));
    return run_program(run_arguments(protocol_, database_, {"--participants", "1", "--stimulus", bake_}));
  }
  std::int64_t test_sessions() {
    return count_in(database_, "SELECT count(*) FROM session WHERE test_data = 1");
  }

  TemporaryFolder folder_;
  std::string scene_ = folder_ / "dam.toml", bake_ = folder_ / "dam.bake";
  std::string protocol_ = folder_ / "short.toml", database_ = folder_ / "study.db";
};

TEST_F(StimulusMatchE2e, TheProtocolsOwnStimulusIsNoTest) {
  const Ended ended = run(scene_, "LoRes", "64");
  ASSERT_EQ(ended.exit_code, 0) << ended.err;
  EXPECT_THAT(ended.err, Not(HasSubstr("test data")));
  EXPECT_EQ(test_sessions(), 0);
}

TEST_F(StimulusMatchE2e, AnotherSceneMethodOrSizeIsTestDataAndSaysSo) {
  const Ended ended = run("data/scenes/single_dam.toml", "HiRes", "32k");
  ASSERT_EQ(ended.exit_code, 0) << ended.err;
  EXPECT_THAT(ended.err,
              AllOf(HasSubstr("method LoRes instead of HiRes"), HasSubstr("n_* 64 instead of 32768"),
                    HasSubstr("scene SingleDam"), HasSubstr("marked as test data")));
  EXPECT_EQ(test_sessions(), 1);
}

}  // namespace
}  // namespace apps::test
