/// Sessions that end before their last unit, and the steps that follow.
#include "libstudy/session/farewell.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "libstudy/store/withdraw.hpp"
#include "stats/base/error.hpp"
#include "tests/libstudy/session_fixture.hpp"

namespace study {
namespace {

using test::consented;
using test::OneSession;
using test::paced_pairs;
using test::wish_at_frame_5;
using ::testing::AllOf;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::Not;
using ::testing::ThrowsMessage;

constexpr const char* ssq_toml = R"(
[[block]]
kind = "ssq"
id = "afterwards"
)";

/// The lines of `seen` from the last one that starts with `begin`; none if no line does.
std::vector<std::string> from(const std::vector<std::string>& seen, const std::string& begin) {
  const auto at = std::find_if(seen.rbegin(), seen.rend(),
                               [&](const std::string& line) { return line.starts_with(begin); });
  return at == seen.rend() ? std::vector<std::string>() : std::vector(at.base() - 1, seen.end());
}

TEST(Farewell, ARefusalIsAskedOnceMoreAndEndsWithThanks) {
  OneSession one(consented());
  one.person.says["take_part"] = test::score(0);
  const auto ending = one.run();
  EXPECT_THAT(one.person.seen, ElementsAre("ask take_part", "offer stay out", "tell refused"));
  EXPECT_EQ(ending.value().how, EarlyEnd::Refused);
  EXPECT_EQ(one.row().state, "refused");
  EXPECT_EQ(one.count("response"), 0);
}

TEST(Farewell, AKeyHitByMistakeAtConsentSendsNobodyAway) {
  OneSession one(consented());
  one.person.says["take_part"] = test::score(0);
  one.person.decides = [&](Offer) {
    one.person.says["take_part"] = test::score(1);
    return false;
  };
  EXPECT_FALSE(one.run().has_value());
  EXPECT_EQ(one.row().state, "done");
  EXPECT_EQ(one.count("response JOIN question USING (question_id) WHERE code = 'take_part' AND score = 1"),
            1);
}

TEST(Farewell, AStopRestsOffersTheLastQuestionnaireAndAsksWhatBecomesOfTheData) {
  OneSession one(paced_pairs("", ssq_toml));
  one.person.says["ssq_3"] = {};  // this item has no answer
  const auto ending = one.run(wish_at_frame_5(Request::EndSession, 1));
  EXPECT_EQ(ending.value().how, EarlyEnd::Stopped);
  const auto seen = from(one.person.seen, "tell over");
  ASSERT_EQ(seen.size(), 5u);
  EXPECT_EQ(seen[0], "tell over 60");
  EXPECT_EQ(seen[1], "offer questionnaire");
  EXPECT_THAT(seen[2], HasSubstr("ask ssq_1 ssq_2"));
  EXPECT_EQ(seen[3], "offer keep");
  EXPECT_EQ(seen[4], "tell kept");
  EXPECT_EQ(one.row().state, "stopped");
  EXPECT_EQ(one.count("response JOIN unit USING (unit_id) WHERE kind = 'ssq' AND score = 1"), 15);
  EXPECT_EQ(one.count("unit WHERE kind = 'ssq' AND state = 'done'"), 1);
  EXPECT_THAT(requested_withdrawals(one.folder / "study.db"), IsEmpty());
  EXPECT_TRUE(one.open().empty());
}

TEST(Farewell, TheQuestionnaireMayBeDeclined) {
  OneSession one(paced_pairs("", ssq_toml));
  one.person.decides = [](Offer offer) { return offer != Offer::Questionnaire; };
  one.run(wish_at_frame_5(Request::EndSession, 1));
  EXPECT_THAT(from(one.person.seen, "tell over"),
              ElementsAre("tell over 60", "offer questionnaire", "offer keep", "tell kept"));
  EXPECT_EQ(one.count("unit WHERE kind = 'ssq' AND state = 'done'"), 0);
}

TEST(Farewell, WhoSawNothingNeitherRestsNorIsAsked) {
  OneSession one(paced_pairs("", ssq_toml));
  SessionHooks hooks;
  hooks.request = [] { return Request::EndSession; };
  one.run(hooks);
  EXPECT_THAT(one.person.seen, ElementsAre("tell over", "tell goodbye"));
}

TEST(Farewell, AStopOnTheRequestOfTheProgramSkipsTheRest) {
  OneSession one(paced_pairs());
  SessionHooks hooks;
  hooks.request = [&] {
    if (one.count("presentation") == 0) return Request::GoOn;
    return one.person.seen.back() == "tell over 60" ? Request::Stop : Request::EndSession;
  };
  EXPECT_EQ(one.run(hooks).value().how, EarlyEnd::Stopped);
  EXPECT_EQ(one.person.seen.back(), "tell over 60");
  EXPECT_EQ(one.row().state, "stopped");
}

TEST(Farewell, APersonWhoStoppedIsNotSentToResume) {
  OneSession one(paced_pairs());
  const auto again = [&] { one.store.add_run(test::run_plan(one.protocol, {"P01"})); };
  EXPECT_THAT(again, ThrowsMessage<base::Error>(HasSubstr("vip-study resume")));
  one.run(wish_at_frame_5(Request::EndSession, 1));
  EXPECT_THAT(again, ThrowsMessage<base::Error>(
                         AllOf(HasSubstr("it is over (stopped)"), Not(HasSubstr("vip-study resume")))));
}

TEST(Farewell, WhatIsToBeDeletedIsDeletedByTheNextOpeningAtTheLatest) {
  const test::TemporaryFolder folder;
  const Protocol protocol = paced_pairs();
  auto store = std::make_unique<Store>(folder / "study.db", sqlite::Open::Create);
  store->add_run(test::run_plan(protocol, {"P01", "P02"}));
  PersonalFile personal(folder / "study.db");
  test::Scripted person;
  person.says["age"] = test::score(40);
  person.decides = [](Offer offer) { return offer != Offer::Keep; };
  test::Desk desk(protocol);
  SessionParts parts = desk.parts(person, *store);
  parts.personal = &personal;
  run_session(protocol, store->open_runs().at(0).sessions.at(0), parts,
              wish_at_frame_5(Request::EndSession, 1));
  EXPECT_EQ(person.seen.back(), "tell deleted");
  EXPECT_THAT(store->requested_withdrawals(), ElementsAre("P01"));
  store.reset();
  EXPECT_THAT(requested_withdrawals(folder / "study.db"), ElementsAre("P01"));

  store = std::make_unique<Store>(folder / "study.db", sqlite::Open::Write);
  EXPECT_THAT(store->left_to_clean(), IsEmpty());
  EXPECT_THAT(store->requested_withdrawals(), IsEmpty());
  const StudyStatus status = read_status(folder / "study.db");
  EXPECT_THAT(status.withdrawn, ElementsAre("P01"));
  ASSERT_EQ(status.sessions.size(), 1u);
  EXPECT_EQ(status.sessions[0].participant, "P02");
  EXPECT_THAT(personal.read("P01"), IsEmpty());
}

}  // namespace
}  // namespace study
