/// Effects of keys, clicks and time on a participant's page.
#include <gtest/gtest.h>

#include <limits>

#include "libstudy/pages/page.hpp"
#include "libstudy/pages/viewing.hpp"
#include "stats/base/error.hpp"

namespace apps {

namespace {

using study::AnswerKind;
using study::Question;

constexpr std::int64_t shown = 5'000'000'000;

/// A time, ms after the page was shown.
std::int64_t at(int ms) { return shown + 1'000'000LL * ms; }

Question scale(int low, int high, bool required = true) {
  Question question;
  question.scale_min = low;
  question.scale_max = high;
  question.required = required;
  return question;
}

Question list(std::vector<std::pair<int, std::string>> items) {
  Question question;
  question.kind = AnswerKind::Choice;
  question.anchors = std::move(items);
  return question;
}

Question number(int low, int high, bool required = true) {
  Question question = scale(low, high, required);
  question.kind = AnswerKind::Number;
  return question;
}

Question words(bool required) {
  Question question;
  question.kind = AnswerKind::Text;
  question.required = required;
  return question;
}

Question of_kind(AnswerKind kind, int low, int high) {
  Question question = scale(low, high);
  question.kind = kind;
  return question;
}

study::PageState page(const std::vector<Question>& questions, double least_s = 0) {
  return {questions, least_s, shown};
}

TEST(PageState, NothingIsChosenBeforehandAndNothingCanBeSkipped) {
  study::PageState state = page({scale(1, 7)});
  EXPECT_FALSE(state.answered(0));
  EXPECT_FALSE(state.can_confirm(at(60'000)));
  state.press(study::PageKey::Enter, at(1000));
  state.click_confirm(at(1100));
  EXPECT_FALSE(state.confirmed());
  EXPECT_EQ(state.missing(), 1u);
}

TEST(PageState, TheFirst300MsCountForNothing) {
  study::PageState state = page({scale(1, 7)});
  state.digit(5, at(299));
  state.click(0, 5, at(299));
  EXPECT_FALSE(state.answered(0));
  state.digit(5, at(300));
  EXPECT_EQ(state.item(0).chosen, 5);

  study::PageState text = page({});
  text.press(study::PageKey::Enter, at(100));
  EXPECT_FALSE(text.confirmed());
  text.press(study::PageKey::Enter, at(301));
  EXPECT_TRUE(text.confirmed());
}

TEST(PageState, AnAnswerCanBeChangedUntilItIsConfirmed) {
  study::PageState state = page({scale(1, 7)});
  state.digit(5, at(1000));
  state.digit(2, at(2500));
  state.press(study::PageKey::Enter, at(4000));
  ASSERT_TRUE(state.confirmed());
  state.digit(7, at(5000));
  state.click(0, 7, at(5000));
  const auto answers = state.answers();
  ASSERT_EQ(answers.size(), 1u);
  EXPECT_EQ(answers[0].answer.score, 2);
  EXPECT_DOUBLE_EQ(answers[0].response_time_s, 2.5);
}

TEST(PageState, AnAnswerTellsWhatItsLastChangeCameFrom) {
  using study::AnswerInput;
  study::PageState state = page({scale(1, 7), scale(1, 7), words(false), scale(1, 7, false)});
  state.digit(5, at(1000));
  state.use(AnswerInput::Ray);
  state.click(1, 3, at(1500));
  state.click(0, 5, at(1600));  // no change of the answer
  state.write(2, "grainy", at(1700));
  state.use(AnswerInput::Stick);
  state.click_confirm(at(2000));
  ASSERT_TRUE(state.confirmed());
  const auto answers = state.answers();
  EXPECT_EQ(answers[0].input, AnswerInput::Keyboard);
  EXPECT_EQ(answers[1].input, AnswerInput::Ray);
  EXPECT_EQ(answers[2].input, AnswerInput::Keyboard);
  EXPECT_EQ(answers[3].input, AnswerInput::Stick);
}

TEST(PageState, ALineHasNoMarkUntilAKeyOrAClickSetsOne) {
  using study::PageKey;
  study::PageState state = page({of_kind(AnswerKind::Vas, 0, 1000), of_kind(AnswerKind::Vas, 0, 8)});
  state.digit(5, at(900));
  EXPECT_FALSE(state.item(0).chosen || state.item(0).cursor);
  state.press(PageKey::Right, at(1000));
  EXPECT_EQ(state.item(0).chosen, 0) << "the first key sets it at an end";
  for (const PageKey key : {PageKey::Left, PageKey::Right, PageKey::Up, PageKey::FarRight, PageKey::Right})
    state.press(key, at(1100));
  EXPECT_EQ(state.item(0).chosen, 220) << "1 %, 10 %, 10 %, 1 %";
  state.press(PageKey::Down, at(1200));
  state.press(PageKey::FarLeft, at(1200));
  EXPECT_EQ(state.item(0).chosen, 20);
  state.click(0, 777, at(1300));
  EXPECT_EQ(state.item(0).chosen, 777);
  state.press(PageKey::Enter, at(1400));
  EXPECT_EQ(state.focus(), 1u) << "a mark needs no Enter to count";
  state.press(PageKey::Down, at(1500));
  EXPECT_EQ(state.item(1).chosen, 8) << "from the right";
  state.press(PageKey::Left, at(1500));
  EXPECT_EQ(state.item(1).chosen, 7) << "at least one score";
  state.click_confirm(at(1600));
  EXPECT_EQ(state.answers()[0].answer.score, 777);
  EXPECT_DOUBLE_EQ(state.answers()[0].response_time_s, 1.3);
}

TEST(PageState, YesOrNoIsChosenByItsLetters) {
  Question question = list({{0, "no"}, {1, "yes"}});
  question.kind = AnswerKind::YesNo;
  study::PageState state = page({question, list({{0, "no"}, {1, "yes"}})});
  state.letter("x", at(1000));
  EXPECT_FALSE(state.answered(0));
  state.letter("y", at(1000));
  EXPECT_EQ(state.item(0).chosen, 1);
  state.letter("n", at(1100));
  EXPECT_EQ(state.item(0).chosen, 0);
  state.press(study::PageKey::Enter, at(1200));
  state.letter("y", at(1300));
  EXPECT_FALSE(state.answered(1)) << "a choice has no letters";
}

TEST(PageState, AReactionIsTheFirstPressAndEndsThePage) {
  study::PageState state = page({of_kind(AnswerKind::Reaction, 0, 1)});
  state.press(study::PageKey::Enter, at(100));
  state.click_confirm(at(100));
  state.tick(at(200));
  EXPECT_FALSE(state.confirmed());
  state.use(study::AnswerInput::Gamepad);
  state.react(at(234));
  state.react(at(400));
  ASSERT_TRUE(state.confirmed());
  EXPECT_EQ(state.answers()[0].answer.score, 1);
  EXPECT_DOUBLE_EQ(state.answers()[0].response_time_s, 0.234);
  EXPECT_EQ(state.answers()[0].input, study::AnswerInput::Gamepad);
  study::PageState other = page({scale(1, 7)});
  other.react(at(1000));
  other.tick(at(60'000));
  EXPECT_FALSE(other.confirmed());
}

TEST(PageState, AReactionThatComesTooLateIsNone) {
  for (const bool pressed : {false, true}) {
    study::PageState state = page({of_kind(AnswerKind::Reaction, 0, 1)});
    state.tick(at(4999));
    EXPECT_FALSE(state.confirmed());
    if (pressed)
      state.react(at(5020));
    else
      state.tick(at(5010));
    ASSERT_TRUE(state.confirmed());
    EXPECT_EQ(state.answers()[0].answer.score, 0);
    EXPECT_DOUBLE_EQ(state.answers()[0].response_time_s, 5);
    EXPECT_FALSE(state.answers()[0].input);
  }
}

TEST(PageState, AReactionBeginsAnewAfterAnInterruption) {
  study::PageState state = page({of_kind(AnswerKind::Reaction, 0, 1)});
  state.leave_out(at(100), at(9000));
  state.react(at(9100));
  EXPECT_FALSE(state.confirmed()) << "the key that closed the dialog";
  state.react(at(9400));
  EXPECT_DOUBLE_EQ(state.answers()[0].response_time_s, 0.4);
}

TEST(PageState, TheSameAnswerAgainIsNoChange) {
  study::PageState state = page({scale(1, 7)});
  state.digit(5, at(1000));
  state.digit(5, at(2000));
  state.click_confirm(at(3000));
  EXPECT_DOUBLE_EQ(state.answers()[0].response_time_s, 1.0);
}

TEST(PageState, DigitsOffTheScaleAndScalesBeyondOneDigit) {
  study::PageState state = page({scale(1, 7), scale(0, 20)});
  for (const int off : {0, 8, 9}) state.digit(off, at(1000));
  EXPECT_FALSE(state.answered(0));
  state.press(study::PageKey::Down, at(1000));
  state.digit(1, at(1100));  // could be the start of 12
  EXPECT_FALSE(state.answered(1));
  state.click(1, 21, at(1200));
  EXPECT_FALSE(state.answered(1));
  state.click(1, 20, at(1300));
  EXPECT_EQ(state.item(1).chosen, 20);
}

TEST(PageState, ArrowsPointAndEnterChooses) {
  study::PageState state = page({scale(1, 7)});
  state.press(study::PageKey::Right, at(1000));
  state.press(study::PageKey::Right, at(1100));
  EXPECT_EQ(state.item(0).cursor, 2);
  EXPECT_FALSE(state.answered(0)) << "pointing is not choosing";
  state.press(study::PageKey::Enter, at(1200));
  EXPECT_EQ(state.item(0).chosen, 2);
  EXPECT_FALSE(state.confirmed());
  state.press(study::PageKey::Left, at(1300));
  state.press(study::PageKey::Left, at(1400));  // stays at the end
  EXPECT_EQ(state.item(0).cursor, 1);
  state.press(study::PageKey::Enter, at(1500));
  state.press(study::PageKey::Enter, at(1600));
  ASSERT_TRUE(state.confirmed());
  EXPECT_EQ(state.answers()[0].answer.score, 1);
}

TEST(PageState, UpAndDownMoveInAList) {
  study::PageState state = page({list({{1, "first"}, {2, "second"}})});
  state.press(study::PageKey::Up, at(1000));
  EXPECT_EQ(state.item(0).cursor, 2) << "from below, the last one";
  state.press(study::PageKey::Up, at(1100));
  state.press(study::PageKey::Enter, at(1200));
  EXPECT_EQ(state.item(0).chosen, 1);
}

TEST(PageState, AListOffersOnlyWhatHasWords) {
  study::PageState state = page({list({{1, "yes"}, {3, "perhaps"}})});
  state.digit(2, at(1000));
  state.click(0, 2, at(1000));
  EXPECT_FALSE(state.answered(0));
  state.digit(3, at(1100));
  EXPECT_EQ(state.item(0).chosen, 3);
}

TEST(PageState, EnterGoesFromQuestionToQuestionAndConfirmsAtTheButton) {
  study::PageState state = page({scale(0, 3), scale(0, 3)});
  state.press(study::PageKey::Enter, at(1000));
  EXPECT_EQ(state.focus(), 0u) << "a required question is not passed over";
  state.digit(1, at(1100));
  state.press(study::PageKey::Enter, at(1200));
  EXPECT_EQ(state.focus(), 1u);
  state.digit(2, at(1300));
  state.press(study::PageKey::Enter, at(1400));
  EXPECT_EQ(state.focus(), state.size());
  EXPECT_FALSE(state.confirmed()) << "reading over them is one Enter away";
  state.press(study::PageKey::Enter, at(1500));
  ASSERT_TRUE(state.confirmed());
  EXPECT_EQ(state.answers()[0].answer.score, 1);
  EXPECT_DOUBLE_EQ(state.answers()[1].response_time_s, 1.3);
}

TEST(PageState, TheButtonNeedsAllRequiredAnswers) {
  study::PageState state = page({scale(0, 3), scale(0, 3), scale(0, 3, false)});
  state.click(0, 0, at(1000));
  EXPECT_FALSE(state.can_confirm(at(1000)));
  state.click(1, 3, at(1100));
  EXPECT_TRUE(state.can_confirm(at(1100)));
  state.click_confirm(at(4000));
  const auto answers = state.answers();
  EXPECT_FALSE(answers[2].answer.score.has_value());
  EXPECT_DOUBLE_EQ(answers[2].response_time_s, 4.0);
}

TEST(PageState, TheButtonLeadsToWhatIsStillOpen) {
  study::PageState state = page({scale(0, 3), scale(0, 3), scale(0, 3)});
  state.click(0, 1, at(1000));
  state.press(study::PageKey::Next, at(1100));
  state.press(study::PageKey::Next, at(1200));
  state.digit(2, at(1300));
  state.press(study::PageKey::Next, at(1400));
  ASSERT_EQ(state.focus(), state.size());
  state.press(study::PageKey::Enter, at(1500));
  EXPECT_EQ(state.focus(), 1u);
  EXPECT_FALSE(state.confirmed());
}

TEST(PageState, ANumberIsCheckedAgainstItsRange) {
  study::PageState state = page({number(16, 99)});
  state.digit(9, at(1000));
  EXPECT_TRUE(state.out_of_range(0));
  state.digit(0, at(1100));
  EXPECT_TRUE(state.answered(0));
  state.digit(0, at(1200));
  EXPECT_TRUE(state.out_of_range(0));
  EXPECT_FALSE(state.can_confirm(at(1200)));
  state.press(study::PageKey::Erase, at(1300));
  state.press(study::PageKey::Enter, at(1400));
  ASSERT_TRUE(state.confirmed());
  EXPECT_EQ(state.answers()[0].answer.score, 90);
}

TEST(PageState, AFieldThatMayBeEmptyMayNotBeWrong) {
  study::PageState state = page({number(16, 99, false)});
  EXPECT_TRUE(state.can_confirm(at(1000)));
  state.digit(7, at(1000));
  EXPECT_FALSE(state.can_confirm(at(1000)));
  state.press(study::PageKey::Enter, at(1100));
  EXPECT_FALSE(state.confirmed());
}

TEST(PageState, NegativeNumbersOnlyWhereTheyCanBe) {
  study::PageState eyes = page({number(-20, 20)}), age = page({number(16, 99)});
  for (study::PageState* state : {&eyes, &age}) {
    state->minus(at(1000));
    state->digit(3, at(1100));
  }
  EXPECT_EQ(eyes.item(0).typed, "-3");
  EXPECT_TRUE(eyes.answered(0));
  EXPECT_EQ(age.item(0).typed, "3");
}

TEST(PageState, WordsThatAreBlankAreNoAnswer) {
  study::PageState state = page({words(true)});
  state.write(0, " \n", at(1000));
  EXPECT_FALSE(state.can_confirm(at(1000)));
  state.write(0, "grainy", at(2000));
  state.click_confirm(at(3000));
  ASSERT_TRUE(state.confirmed());
  EXPECT_EQ(state.answers()[0].answer.words, "grainy");
  EXPECT_FALSE(state.answers()[0].answer.score.has_value());
  EXPECT_DOUBLE_EQ(state.answers()[0].response_time_s, 2.0);
}

TEST(PageState, ATextCannotBeLeftBeforeItsTime) {
  study::PageState state = page({}, 5);
  EXPECT_DOUBLE_EQ(state.wait_s(at(2000)), 3.0);
  state.press(study::PageKey::Enter, at(4999));
  state.click_confirm(at(4999));
  EXPECT_FALSE(state.confirmed());
  state.press(study::PageKey::Enter, at(5000));
  EXPECT_TRUE(state.confirmed());
}

TEST(PageState, TimeInADialogIsNoResponseTimeAndWhatFollowsIsGuarded) {
  study::PageState state = page({scale(1, 7)}, 3);
  state.leave_out(at(1000), at(11'000));
  EXPECT_DOUBLE_EQ(state.wait_s(at(11'000)), 2.0);
  state.digit(4, at(11'200));
  EXPECT_FALSE(state.answered(0));
  state.digit(4, at(12'000));
  state.click_confirm(at(14'000));
  ASSERT_TRUE(state.confirmed());
  EXPECT_DOUBLE_EQ(state.answers()[0].response_time_s, 2.0);
}

TEST(PageState, NoAnswersBeforeTheConfirmation) {
  study::PageState state = page({scale(1, 7)});
  state.digit(4, at(1000));
  EXPECT_THROW(state.answers(), std::logic_error);
}

TEST(Viewing, ThePictureIsAWindowOntoTheScene) {
  // Height twice the distance: 45 degrees up and 45 down.
  EXPECT_NEAR(study::vertical_fov_deg(1200, 600), 90, 1e-12);
  EXPECT_NEAR(study::vertical_fov_deg(2 * 700 * 0.57735026918962576, 700), 60, 1e-9);  // 0.57... = tan 30 deg
  EXPECT_NEAR(study::picture_height_mm(531.2, 1920, 1080), 298.8, 1e-9);
}

TEST(Viewing, LengthsThatNoDesktopHasAreErrors) {
  for (const double bad : {0.0, -300.0, 0.3, 1e6, std::numeric_limits<double>::quiet_NaN()}) {
    EXPECT_THROW(study::vertical_fov_deg(bad, 600), base::Error) << bad;
    EXPECT_THROW(study::vertical_fov_deg(300, bad), base::Error) << bad;
    EXPECT_THROW(study::picture_height_mm(bad, 1920, 1080), base::Error) << bad;
  }
  EXPECT_THROW(study::picture_height_mm(500, 0, 1080), base::Error);
}

}  // namespace

}  // namespace apps
