#include "libstudy/session/session.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "libstudy/observer/observer.hpp"
#include "stats/base/error.hpp"
#include "tests/libstudy/session_fixture.hpp"

namespace study {
namespace {

using test::OneSession;
using test::paced_pairs;
using test::wish_at_frame_5;
using ::testing::ElementsAre;

/// The shipped pilot with a screening question that can rule a person out, and a symptom scale that stops the
/// session from 12 on.
Protocol guarded() {
  return parse_protocol(
      test::with_before(test::shipped_text("ptpe_pilot"), "[[block]]\nkind = \"stimulus\"", R"([[block]]
kind = "screening"
id = "screening"

[[block.question]]
id = "epilepsy"
kind = "choice"
text = "Do flickering lights harm you?"
anchors = {0 = "no", 1 = "yes"}
accept = [0, 0]

[[block]]
kind = "fms"
id = "sickness"
stop_at = 12

)"),
      "guarded.toml");
}

TEST(Session, RefusedConsentEndsItAndKeepsNoAnswer) {
  OneSession one(guarded());
  one.person.says["take_part"] = test::score(0);
  one.run();
  EXPECT_THAT(one.person.seen,
              ElementsAre("read welcome", "ask take_part", "offer stay out", "tell refused"));
  EXPECT_EQ(one.row().state, "refused");
  EXPECT_EQ(one.count("response"), 0);
  EXPECT_TRUE(one.open().empty());
  EXPECT_TRUE(one.store.taken_slots(one.protocol.sha256).empty());
}

TEST(Session, WhoIsRuledOutByScreeningSeesNothing) {
  OneSession one(guarded());
  one.person.says["epilepsy"] = test::score(1);
  one.run();
  EXPECT_THAT(one.person.seen,
              ElementsAre("read welcome", "ask take_part", "ask epilepsy", "tell not eligible"));
  EXPECT_EQ(one.row().state, "not eligible");
  EXPECT_EQ(one.count("presentation"), 0);
  EXPECT_EQ(one.count("event WHERE detail LIKE '%epilepsy%' OR detail LIKE '%screening%'"), 0);
}

TEST(Session, AStopRuleOffersARestAndShowsNothingMore) {
  OneSession one(guarded());
  one.person.says["epilepsy"] = test::score(0);
  one.person.says["fms"] = test::score(12);
  one.run();
  const auto& seen = one.person.seen;
  EXPECT_THAT(std::vector(seen.end() - 4, seen.end()),
              ElementsAre("ask fms", "tell over", "offer keep", "tell kept"));
  EXPECT_EQ(one.row().state, "stopped");
  EXPECT_EQ(one.count("presentation"), 0);
  EXPECT_EQ(one.count("response JOIN question USING (question_id) WHERE code = 'fms' AND score = 12"), 1);
  EXPECT_TRUE(one.open().empty());
}

TEST(Session, ATrialIsRepeatedOnWishAndBothShowingsStay) {
  OneSession one(paced_pairs());
  std::vector<int> attempts;
  SessionHooks hooks = wish_at_frame_5(CutCause::Experimenter, 2);
  hooks.done = [&](const UnitDone& unit) {
    if (unit.unit.trial) attempts.push_back(unit.attempt);
  };
  one.run(hooks);
  EXPECT_THAT(attempts, ElementsAre(3, 1, 1, 1));
  EXPECT_EQ(one.count("presentation WHERE state = 'interrupted'"), 2);
  EXPECT_EQ(one.count("presentation WHERE state = 'played'"), 8);
  EXPECT_EQ(one.count("response WHERE attempt = 3"), 2);
  EXPECT_EQ(one.row().state, "done");
}

TEST(Session, ATrialThatTheScreenDidNotShowIsShownAgain) {
  OneSession one(paced_pairs());
  one.run(wish_at_frame_5(CutCause::Minimised, 1));
  EXPECT_EQ(one.count("presentation WHERE state = 'interrupted' AND attempt = 1"), 1);
  EXPECT_EQ(one.count("presentation WHERE state = 'played' AND attempt = 2"), 2);
  EXPECT_EQ(one.count("note WHERE words LIKE '%window was minimised'"), 1);
  EXPECT_EQ(one.row().state, "done");
}

TEST(Session, ARepeatAfterTheFirstAnswerAsksItAgain) {
  OneSession one(paced_pairs());
  bool wished = false;
  SessionHooks hooks;
  hooks.request = [&] {
    // The experimenter cuts the trial during the rest between the two questions of the first trial.
    const bool now = !wished && one.person.seen.size() > 1 && one.person.seen.back() == "rest 9";
    wished = wished || now;
    return now ? Request(CutCause::Experimenter) : Request::GoOn;
  };
  one.run(hooks);
  const auto asked = std::count(one.person.seen.begin(), one.person.seen.end(), "ask preference");
  EXPECT_EQ(asked, 5);
  EXPECT_EQ(one.count("response JOIN question USING (question_id) WHERE code = 'preference'"), 5);
  EXPECT_EQ(one.count("response JOIN question USING (question_id) WHERE code = 'ease'"), 4);
}

TEST(Session, AfterAStopBetweenTwoQuestionsOnlyTheSecondIsAsked) {
  OneSession one(paced_pairs());
  SessionHooks hooks;
  hooks.request = [&] { return one.person.seen.back() == "rest 9" ? Request::Stop : Request::GoOn; };
  one.person.seen = {"begin"};
  EXPECT_THROW(one.run(hooks), Stopped);
  one.person.seen.clear();
  one.run();
  EXPECT_THAT(std::vector<std::string>(one.person.seen.begin(), one.person.seen.begin() + 7),
              ElementsAre("first 1", "black 0.5", "black 1", "second 1", "black 0.5", "rest 9", "ask ease"));
  EXPECT_EQ(one.count("response JOIN question USING (question_id) WHERE code = 'preference'"), 4);
}

TEST(Session, TheExperimenterEndsIt) {
  OneSession one(paced_pairs());
  one.run(wish_at_frame_5(Request::EndSession, 1));
  const auto& seen = one.person.seen;
  EXPECT_THAT(std::vector(seen.end() - 3, seen.end()),
              ElementsAre("tell over 60", "offer keep", "tell kept"));
  EXPECT_EQ(one.row().state, "stopped");
  EXPECT_EQ(one.count("presentation WHERE state = 'interrupted'"), 1);
  EXPECT_TRUE(one.open().empty());
}

TEST(Session, APauseWaitsBeforeTheNextUnit) {
  OneSession one(paced_pairs());
  int left = 50;
  SessionHooks hooks;
  hooks.request = [&] { return left-- > 0 ? Request::Pause : Request::GoOn; };
  one.run(hooks);
  EXPECT_EQ(one.row().state, "done");
  EXPECT_LE(left, 0);
  EXPECT_EQ(one.person.seen.front(), "held") << "the participant reads that the session is paused";
  EXPECT_EQ(std::count(one.person.seen.begin(), one.person.seen.end(), "held"), 1);
}

TEST(Session, WhoLeavesDropsOutAndFreesTheSlot) {
  OneSession one(guarded());
  FeatureTable features;
  const auto observer = make_observer("dropout:0.3", features);
  const auto runs = one.open();
  run_session(one.protocol, runs.at(0).sessions.at(0), one.desk.parts(*observer, one.store), {});
  EXPECT_EQ(one.row().state, "dropped out");
  EXPECT_TRUE(one.open().empty());
  EXPECT_TRUE(one.store.taken_slots(one.protocol.sha256).empty());
}

TEST(Session, AnAnswerOffTheScaleIsAnErrorAndIsNotStored) {
  OneSession one(test::pilot());
  for (const Answer& bad : {test::score(8), test::score(0), test::words("much"), Answer{}}) {
    one.person.says["satisfaction"] = bad;
    EXPECT_THROW(one.run(), base::Error);
    EXPECT_EQ(one.count("response JOIN question USING (question_id) WHERE code = 'satisfaction'"), 0);
  }
  one.person.says["satisfaction"] = test::score(7);
  one.run();
  EXPECT_EQ(one.row().state, "done");
}

}  // namespace
}  // namespace study
