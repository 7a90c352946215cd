/// The endings of a run's sessions, and the command's exit status for them.
#include "apps/study/session_player.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <CLI/CLI.hpp>

#include "tests/libstudy/session_fixture.hpp"

namespace apps {
namespace {

using study::test::Scripted;
using ::testing::HasSubstr;

/// Plays the sessions of a run with a scripted participant, on a virtual clock and without a window.
class Played : public ::testing::Test {
 protected:
  Played() {
    setup_.virtual_clock = true;
    setup_.clock = std::make_unique<study::VirtualClock>();
    setup_.display = std::make_unique<study::NullDisplay>();
    study::RunOptions options;
    options.display = "none";
    setup_.stimuli =
        std::make_unique<study::CellStimuli>(options, protocol_, stats::PtpeModel{}, study::Viewing{});
    auto person = std::make_unique<Scripted>();
    person_ = person.get();
    person_->says = {{"age", study::test::score(40)}, {"remarks", study::test::words("")}};
    setup_.participant = std::move(person);
    play_.database = folder_ / "study.db";
  }

  /// Plays the sessions and returns the command's exit status; `observer`: the planned observer, none for a
  /// person.
  int play(const std::optional<std::string>& observer = {}, const std::vector<std::string>& codes = {"P01"}) {
    study::RunPlan plan = study::test::run_plan(protocol_, codes);
    for (auto& session : plan.sessions) session.observer = observer;
    study::Store store(play_.database, study::sqlite::Open::Create);
    store.add_run(plan);
    ::testing::internal::CaptureStdout();
    const RunEnd end = play_run(store, store.open_runs().at(0), protocol_, setup_, play_);
    out_ = ::testing::internal::GetCapturedStdout();
    try {
      end_command(play_.database, {end, {}});
      return 0;
    } catch (const CLI::RuntimeError& ended) {
      return ended.get_exit_code();
    }
  }
  std::string state(const std::string& code) {
    for (const auto& row : study::read_status(play_.database).sessions) {
      if (row.participant == code) return row.state;
    }
    return "none";
  }

  ::test::TemporaryFolder folder_;
  const study::Protocol protocol_ = study::test::consented();
  study::SessionSetup setup_;
  Scripted* person_ = nullptr;  ///< owned by setup_
  PlayOptions play_;
  std::string out_;  ///< what was printed
};

TEST_F(Played, ASessionThatIsDoneIsNought) {
  EXPECT_EQ(play(), 0);
  EXPECT_EQ(state("P01"), "done");
  EXPECT_THAT(out_, ::testing::Not(HasSubstr("the session is over")));
}

TEST_F(Played, AStoppedSessionIsThree) {
  setup_.request = [](const auto&) { return study::Request::EndSession; };
  EXPECT_EQ(play(), 3);
  EXPECT_EQ(state("P01"), "stopped");
  EXPECT_THAT(out_, HasSubstr("P01 stopped before the end: the session is over"));
}

TEST_F(Played, ARefusedConsentIsFour) {
  person_->says["take_part"] = study::test::score(0);
  EXPECT_EQ(play(), 4);
  EXPECT_EQ(state("P01"), "refused");
  EXPECT_THAT(out_, HasSubstr("P01 did not consent: the session is over"));
}

TEST_F(Played, OfSeveralSessionsAStopIsTold) {
  setup_.request = [this](const auto&) {
    if (!person_->seen.empty() && person_->seen.back() == "tell refused")  // P02 consents
      person_->says["take_part"] = study::test::score(1);
    return state("P01") == "refused" ? study::Request::EndSession : study::Request::GoOn;
  };
  person_->says["take_part"] = study::test::score(0);
  EXPECT_EQ(play({}, {"P01", "P02"}), 3);
  EXPECT_EQ(state("P01"), "refused");
  EXPECT_EQ(state("P02"), "stopped");
}

TEST_F(Played, AnObserversRefusalIsNoNewsToAnyone) {
  person_->says["take_part"] = study::test::score(0);
  EXPECT_EQ(play("scripted"), 0);
  EXPECT_EQ(state("P01"), "refused");
}

TEST_F(Played, AMirrorIsAnEventOfEachSessionAndUnblindsWhereItRevealsStimuli) {
  const auto sessions_with = [&](const std::string& kind) {
    return study::sqlite::Connection(play_.database, study::sqlite::Open::Read)
        .integer("SELECT count(DISTINCT session_id) FROM event WHERE kind = '" + kind + "'");
  };
  ASSERT_EQ(play(), 0);
  EXPECT_EQ(sessions_with("mirror opened"), 0);
  EXPECT_EQ(sessions_with("pages mirrored"), 0);
  play_.database = folder_ / "mirrored.db";
  play_.mirror = true;
  ASSERT_EQ(play({}, {"P01", "P02"}), 0);
  EXPECT_EQ(sessions_with("mirror opened"), 0);
  EXPECT_EQ(sessions_with("pages mirrored"), 2);
  play_.database = folder_ / "revealed.db";
  play_.mirror_reveal = true;
  ASSERT_EQ(play({}, {"P01", "P02"}), 0);
  EXPECT_EQ(sessions_with("mirror opened"), 2);
  EXPECT_EQ(sessions_with("pages mirrored"), 0);
}

}  // namespace
}  // namespace apps
