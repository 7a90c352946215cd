/// Adaptive procedures in sessions: what they show, and that a resumed session continues exactly.

#include "libstudy/design/adaptive_track.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <map>
#include <set>

#include "libstudy/observer/detection_observer.hpp"
#include "stats/base/error.hpp"
#include "stats/base/file.hpp"
#include "tests/libstudy/session_fixture.hpp"

namespace study {
namespace {

using testing::HasSubstr;

const std::string quest_text = base::read_file(VIP_TEST_DIR "/../protocols/hitch_quest.toml", 1 << 20);
const std::string staircase_text =
    base::read_file(VIP_TEST_DIR "/fuzz/corpus/protocol/staircase.toml", 1 << 20);

std::string changed(std::string text, const std::string& from, const std::string& to) {
  const std::size_t at = text.find(from);
  EXPECT_NE(at, std::string::npos) << from;
  return text.replace(at, from.size(), to);
}

Protocol read(const std::string& text) {
  Protocol protocol = parse_protocol(text, "own.toml");
  override_trial_seconds(protocol, 0.5);
  return protocol;
}

/// The protocol quest_text with 12 trials, and with a hitch every 0.4 s, so that a trial of 0.5 s has one.
std::string short_quest() {
  std::string text = changed(quest_text, "trials = 40", "trials = 12");
  for (std::size_t at = 0; (at = text.find("period_s = 2", at)) != std::string::npos;)
    text.replace(at, 12, "period_s = 0.4");
  return text;
}

/// A protocol whose adaptive procedure "ptpe" chooses among 15 settings of mean and SD of the frame rate.
std::string placement_text() {
  std::string levels;
  for (const int mean : {10, 20, 30, 45, 60})
    for (const int sd : {0, 4, 8})
      levels += "[[factor.level]]\nname = \"m" + std::to_string(mean) + "s" + std::to_string(sd) +
                "\"\ntiming = {profile = \"moments\", mean_fps = " + std::to_string(mean) +
                ", sd_fps = " + std::to_string(sd) + "}\n";
  const std::size_t first = quest_text.find("[[factor.level]]"), end = quest_text.find("[design]");
  std::string text = quest_text.substr(0, first) + levels + quest_text.substr(end);
  const std::size_t procedure = text.find("[procedure]"), pacing = text.find("[pacing]");
  text = text.substr(0, procedure) +
         "[procedure]\nkind = \"ptpe\"\nfactor = \"hitch\"\nquestion = \"stall\"\ntrials = 10\nfixed = "
         "2\nmost_of_one = 2\n" +
         text.substr(pacing);
  return changed(text,
                 "kind = \"choice\"\ntext = \"Did the motion stall?\"\nanchors = {0 = \"no\", 1 = \"yes\"}",
                 "kind = \"scale\"\ntext = \"How satisfied?\"\nscale = [1, 7]");
}

/// Plays a session of one simulated person. The program stops after every `stop_after` trials and resumes.
/// Returns the cells of each trial in the order shown, with -1 as the second one if a trial has one stimulus.
std::vector<std::pair<int, int>> play(const Protocol& protocol, const std::string& observer, int stop_after) {
  const test::TemporaryFolder folder;
  const auto path = folder / "study.db";
  {
    Store store(path, sqlite::Open::Create);
    store.add_run(test::run_plan(protocol, {"P01"}));
  }
  FeatureTable features;
  for (int runs = 0; runs < 200; ++runs) {
    Store store(path, sqlite::Open::Write);
    const auto open = store.open_runs();
    if (open.empty()) break;
    const auto person = make_observer(observer, features);
    test::Desk desk(protocol);
    int done = 0;
    SessionHooks hooks;
    hooks.done = [&](const auto& unit) { done += unit.unit.trial.has_value(); };
    hooks.request = [&] { return done >= stop_after ? Request::Stop : Request::GoOn; };
    try {
      run_session(protocol, open[0].sessions.at(0), desk.parts(*person, store), hooks);
    } catch (const Stopped&) {
    }
  }
  std::vector<std::pair<int, int>> cells;
  sqlite::Connection database(path, sqlite::Open::Read);
  sqlite::Statement row(
      database,
      "SELECT t.first_cell, coalesce(t.second_cell, -1) FROM trial t JOIN unit u USING (trial_id) "
      "WHERE u.kind = 'stimulus' ORDER BY t.position");
  while (row.step()) cells.emplace_back(static_cast<int>(row.integer(0)), static_cast<int>(row.integer(1)));
  EXPECT_EQ(database.integer(
                "SELECT count(*) FROM trial t JOIN presentation p USING (trial_id) WHERE p.interval = 0 "
                "AND p.state = 'played' AND p.cell <> t.first_cell"),
            0)
      << "the stored cells are those shown";
  return cells;
}

constexpr int never = 1 << 20;

TEST(AdaptiveTrack, AResumedSessionContinuesExactly) {
  const struct {
    std::string name, text, observer;
  } cases[] = {{"QUEST+", short_quest(), "detect:hitch_ms,threshold=80"},
               {"staircase", staircase_text, "detect:latency_ms,threshold=60"},
               {"placement", placement_text(), "ptpe:a=25,b=0.02"}};
  for (const auto& one : cases) {
    SCOPED_TRACE(one.name);
    const Protocol protocol = read(one.text);
    const auto whole = play(protocol, one.observer, never);
    EXPECT_EQ(whole.size(), static_cast<std::size_t>(protocol.design.procedure->trials));
    EXPECT_GT(std::set(whole.begin(), whole.end()).size(), 2u) << "the track moves";
    EXPECT_EQ(play(protocol, one.observer, 1), whole);
    EXPECT_EQ(play(protocol, one.observer, 5), whole);
  }
}

TEST(AdaptiveTrack, AFifthOfPlacedTrialsLieBetweenTheEndsUnlessTheProtocolSaysOtherwise) {
  const auto fixed = [](const std::string& text) {
    return parse_protocol(text, "study.toml").design.procedure->fixed;
  };
  EXPECT_EQ(fixed(changed(placement_text(), "fixed = 2\n", "")), 2);
  EXPECT_EQ(fixed(changed(placement_text(), "fixed = 2\n", "fixed = 0\n")), 0);
  EXPECT_EQ(fixed(changed(changed(placement_text(), "fixed = 2\n", ""), "trials = 10", "trials = 2")), 2);
}

TEST(AdaptiveTrack, FixedTrialsAreInTheirPlaceAndNoLevelTooOften) {
  const auto cells = play(read(placement_text()), "ptpe:a=25,b=0.02", never);
  for (int trial = 0; trial < 10; ++trial)
    EXPECT_EQ(cells[static_cast<std::size_t>(trial)].first % 3 == 1, trial % 5 == 3) << "SD 4: " << trial;
  const auto quest = play(read(short_quest()), "detect:hitch_ms,threshold=80", never);
  for (int i = 0; i < 6; ++i) EXPECT_EQ(quest[static_cast<std::size_t>(i)].first, i * 11 / 5);
  std::map<int, int> times;
  for (const auto& [first, second] : cells) EXPECT_LE(++times[first], 2);
}

TEST(AdaptiveTrack, PlacementLearnsFromEarlierSessionsOfTheSameKind) {
  const Protocol protocol = read(placement_text());
  const test::TemporaryFolder folder;
  Store store(folder / "study.db", sqlite::Open::Create);
  store.add_run(test::run_plan(protocol, {"P01", "P02", "P03"}));
  const auto sessions = store.open_runs().at(0).sessions;
  const std::string question = protocol.design.procedure->question;
  FeatureTable features;
  const auto person = make_observer("ptpe:a=25,b=0.02", features);
  for (const std::size_t i : {0u, 1u}) {
    EXPECT_EQ(store.earlier_answers(sessions.at(i).id, question).size(), 10 * i);
    test::Desk desk(protocol);
    run_session(protocol, sessions.at(i), desk.parts(*person, store), {});
  }
  EXPECT_EQ(store.earlier_answers(sessions.at(2).id, question).size(), 20u);
  EXPECT_EQ(store.earlier_answers(sessions.at(0).id, question).size(), 0u) << "later sessions do not count";
  sqlite::Connection(folder / "study.db", sqlite::Open::Write)
      .execute("UPDATE session SET observer = NULL WHERE participant = 'P01'");
  EXPECT_EQ(store.earlier_answers(sessions.at(2).id, question).size(), 10u)
      << "people and observers are apart";

  // Everyone before was satisfied at any rate, so the first setting is lower.
  TrackAnswers answers;
  const auto mean_of = [&](const TrackAnswers& known) {
    const int cell = chosen_trial(protocol, *sessions.at(2).units.back().trial, known).first;
    return protocol.design.cells[static_cast<std::size_t>(cell)].levels[0];
  };
  const int before = mean_of(answers);
  for (int cell = 0; cell < 15; ++cell) answers.earlier.push_back({cell, {}, 7});
  EXPECT_LT(mean_of(answers), before);
}

TEST(AdaptiveTrack, PairsKeepTheStandardAndTheirOrder) {
  const Protocol protocol = read(staircase_text);
  const auto cells = play(protocol, "detect:latency_ms,threshold=60", never);
  int standard_first = 0;
  for (const auto& [first, second] : cells) {
    EXPECT_TRUE((first == 0) != (second == 0));
    standard_first += first == 0;
  }
  EXPECT_EQ(standard_first, static_cast<int>(cells.size()) / 2);
}

/// Simulates this number of people with 40 trials each. Returns for how many the 95 % interval of the
/// threshold contains the true threshold.
int recovered(int people) {
  const Protocol protocol = parse_protocol(quest_text, "own.toml");
  int covered = 0;
  for (int person = 0; person < people; ++person) {
    const DetectionObserver observer({"hitch_ms", 80, 4, 0, 0.02, 0.2});
    Occasion occasion{"P" + std::to_string(person), 7, 0, BlockKind::Stimulus, {}};
    const double truth = 80 * std::exp(0.2 * normal_of(person_key(occasion), 0));
    PlannedTrial planned;
    std::vector<TrackAnswer> answers;
    for (int trial = 0; trial < protocol.design.procedure->trials; ++trial) {
      const int cell = chosen_trial(protocol, planned, {answers}).first;
      occasion.position = trial;
      occasion.shown = {{cell, protocol.design.cells[static_cast<std::size_t>(cell)], {}, 0, 0}};
      answers.push_back({cell, {}, observer.score(*all_questions(protocol).back().second, occasion, true)});
    }
    const stats::GridEstimate threshold = estimate_track(protocol, 0, answers).threshold;
    covered += threshold.low <= truth && truth <= threshold.high;
  }
  return covered;
}

TEST(AdaptiveTrack, QuestRecoversTheThresholdOfSimulatedPeople) {
  EXPECT_GE(recovered(60), 52) << "95 % of 60 with a binomial error of 1.7";
}

TEST(AdaptiveTrackSlow, QuestRecoversTheThresholdOf500People) {
  const int covered = recovered(500);
  EXPECT_GE(covered, 465) << "93 %";
  EXPECT_LE(covered, 485) << "97 %";
}

TEST(AdaptiveTrack, RefusesWhatItCannotDo) {
  const auto error_of = [](const std::string& text) {
    try {
      parse_protocol(text, "own.toml");
    } catch (const base::Error& error) {
      return std::string(error.what());
    }
    return std::string("no error");
  };
  const struct {
    std::string from, to, words;
  } cases[] = {{"factor = \"hitch\"", "factor = \"hitches\"", "is no factor"},
               {"axis = \"hitch_ms\"", "axis = \"base_fps\"", "does not rise from level to level"},
               {"axis = \"hitch_ms\"", "axis = \"low_fps\"", "is no key of the timing of level"},
               {"question = \"stall\"", "question = \"staller\"", "is not asked in the trials"},
               {"positive = 1", "positive = 4", "is no answer of that question"},
               {"kind = \"quest_plus\"", "kind = \"quest\"", "quest_plus"},
               {"fixed = 6", "fixed = 50", "exceeds trials"},
               {"most_of_one = 12", "most_of_one = 2", "allows fewer than 40 trials"},
               {"order = \"shuffle\"", "order = \"latin\"", "interleaves its tracks"},
               {"duration_s = 4", "duration_s = 4\nrepetitions = 2", "cannot repeat cells"},
               {"lapse = [0.01, 0.03]", "lapse = []", "lapse"}};
  for (const auto& one : cases) {
    const std::string error = error_of(changed(quest_text, one.from, one.to));
    EXPECT_THAT(error, HasSubstr(one.words)) << one.to;
    EXPECT_THAT(error, HasSubstr("mend: ")) << one.to;
  }
  EXPECT_THAT(error_of(changed(staircase_text, "steps = [2, 1]", "steps = [1.5]")),
              HasSubstr("no whole number"));
  EXPECT_THAT(error_of(changed(staircase_text, "start = \"l120\"", "start = \"l7\"")),
              HasSubstr("is no level"));
}

}  // namespace
}  // namespace study
