/// Repeated cuts do not make a stimulus flash: a trial is repeated up to three times, with black between the
/// showings. Then the session pauses.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>

#include "libstudy/session/repeats.hpp"
#include "stats/base/error.hpp"
#include "tests/libstudy/permission_fixture.hpp"
#include "tests/libstudy/session_fixture.hpp"

namespace study {
namespace {

using ::testing::AllOf;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::ThrowsMessage;

constexpr std::int64_t second_ns = 1'000'000'000;

/// Records when the display changes from black to a stimulus and back.
class Lamp final : public Display {
 public:
  explicit Lamp(const Clock& clock) : clock_(clock) {}
  std::string description() const override { return "lamp"; }
  TimingGrade grade() const override { return TimingGrade::CpuSubmit; }
  double refresh_hz() const override { return 0; }
  void render(Stimulus&) override {}
  PresentTimes present(std::int64_t scheduled_ns, Clock& clock) override {
    clock.wait_until(scheduled_ns);
    turn(true);
    PresentTimes times;
    times.submitted_ns = clock.now_ns();
    return times;
  }
  void clear() override { turn(false); }
  bool lit() const { return lit_; }

  std::vector<std::int64_t> turns_ns;  ///< on, off, on, ...

 private:
  void turn(bool lit) {
    if (lit != lit_) turns_ns.push_back(clock_.now_ns());
    lit_ = lit;
  }

  const Clock& clock_;
  bool lit_ = false;
};

/// An eye tracker of eyes that are closed if `closed` returns true.
class Eyes final : public GazeSource {
 public:
  Eyes(const Clock& clock, std::function<bool()> closed) : clock_(clock), closed_(std::move(closed)) {}
  GazeOrigin origin() const override { return GazeOrigin::Tracker; }
  void start() override {}
  std::vector<GazeSample> take() override {
    if (silent) return {};
    GazeSample sample;
    sample.sampled_ns = clock_.now_ns();
    sample.valid = !closed_();
    return {sample};
  }
  void stop() override {}
  std::string trouble() override { return why; }

  bool silent = false;
  std::string why;  ///< why no samples come

 private:
  const Clock& clock_;
  std::function<bool()> closed_;
};

/// A person who continues at once on each page; simulated if `simulated_by` is set.
class Person final : public Participant {
 public:
  explicit Person(test::Scripted& scripted) : scripted_(scripted) {}
  std::optional<std::string> simulated() const override { return simulated_by; }
  void read(const Block& block, double least_s, Clock& clock, const Check& check) override {
    scripted_.read(block, least_s, clock, check);
  }
  std::vector<TimedAnswer> ask(const Block& block, std::span<const Question> questions,
                               const Occasion& occasion, Clock& clock, const Check& check) override {
    return scripted_.ask(block, questions, occasion, clock, check);
  }
  void pause(const Pause& pause, Clock& clock, const Check& check) override {
    scripted_.pause(pause, clock, check);
    if (pause.kind == PauseKind::Trouble) ++troubles;
  }

  std::optional<std::string> simulated_by;
  int troubles = 0;

 private:
  test::Scripted& scripted_;
};

/// A session of asking_protocol() on a Lamp.
struct Flashing : test::OneSession {
  Flashing() : OneSession(test::asking_protocol()) {
    person.says[gaze_question] = test::score(1);
    person.says["rating"] = test::score(4);
  }

  /// Cuts each showing for this cause as soon as possible, until the session has paused `pauses` times.
  SessionHooks cut_by(CutCause cause, int pauses) {
    SessionHooks hooks;
    hooks.request = [=, this]() -> Request {
      const bool endless = lamp.turns_ns.size() > 40;
      if (sitting.troubles >= pauses || endless) return Request::Stop;
      if (cause != CutCause::Gaze && lamp.lit()) return cause;
      return Request::GoOn;
    };
    if (cause == CutCause::Gaze) closed = [this] { return lamp.lit(); };
    return hooks;
  }
  void play(const SessionHooks& hooks) {
    SessionParts parts{desk.clock, lamp, desk.stimuli, sitting, store, &personal, true};
    parts.gaze = &eyes;
    const auto runs = open();
    run_session(protocol, runs.at(0).sessions.at(0), parts, hooks);
  }
  std::vector<std::string> events(const std::string& kind) {
    return test::column(folder / "study.db",
                        "SELECT detail FROM event WHERE kind = '" + kind + "' ORDER BY event_id");
  }

  Lamp lamp{desk.clock};
  std::function<bool()> closed = [] { return false; };
  Eyes eyes{desk.clock, [this] { return closed(); }};
  Person sitting{person};
};

std::vector<CutCause> all_causes() {
  std::vector<CutCause> all;
  for (int cause = 0; cause <= static_cast<int>(CutCause::Last); ++cause)
    all.push_back(static_cast<CutCause>(cause));
  return all;
}

TEST(Repeats, NoCauseOfACutMakesAStimulusFlashAndTheSessionPauses) {
  for (const CutCause cause : all_causes()) {
    const std::string why = words_of(cause).happened;
    ASSERT_FALSE(why.empty());
    ASSERT_FALSE(words_of(cause).mend.empty());
    Flashing one;
    EXPECT_THROW(one.play(one.cut_by(cause, 2)), Stopped) << why;
    // Two rounds of one showing and three repeats.
    const auto& turns_ns = one.lamp.turns_ns;
    ASSERT_EQ(turns_ns.size(), 16u) << why;
    for (std::size_t i = 3; i < turns_ns.size(); ++i)
      EXPECT_GT(turns_ns[i] - turns_ns[i - 3], second_ns) << why << ": three changes in a second, " << i;
    for (std::size_t i = 2; i < turns_ns.size(); i += 2)
      EXPECT_GE(turns_ns[i] - turns_ns[i - 1], second_ns) << why << ": too little black";
    EXPECT_EQ(one.count("presentation WHERE state = 'interrupted'"), 8);
    EXPECT_THAT(one.events("trial interrupted"), ::testing::Each(why));
    EXPECT_THAT(one.events("paused by the program"),
                ::testing::Each(AllOf(HasSubstr("4 times"), HasSubstr(why))));
  }
}

TEST(Repeats, ASimulatedParticipantEndsWithAnErrorAndTheSessionCanBeResumed) {
  Flashing one;
  one.sitting.simulated_by = "scripted";
  EXPECT_THAT([&] { one.play(one.cut_by(CutCause::Recentred, 1)); },
              ThrowsMessage<base::Error>(AllOf(HasSubstr("cut 4 times"), HasSubstr("recentred"),
                                               HasSubstr("vip-study resume continues"))));
  EXPECT_EQ(one.count("presentation WHERE state = 'interrupted'"), 4);
  one.play({});
  EXPECT_EQ(one.row().state, "done");
}

TEST(Repeats, ThreeCutsAreNoReasonToPause) {
  Flashing one;
  SessionHooks hooks = test::wish_at_frame_5(CutCause::Focus, 3);
  one.play(hooks);
  EXPECT_EQ(one.sitting.troubles, 0);
  EXPECT_EQ(one.count("presentation WHERE state = 'interrupted'"), 3);
  EXPECT_EQ(one.row().state, "done");
}

TEST(Repeats, ThePauseLastsUntilTheExperimenterGoesOn) {
  Flashing one;
  std::vector<Trouble> told;
  int held = -1;  // requests left in the experimenter's pause; -1: no pause yet
  SessionHooks hooks = one.cut_by(CutCause::Rate, 100);
  hooks.request = [&, cut = hooks.request]() -> Request {
    if (held > 0 && --held > 0) return Request::Pause;
    return held == 0 ? Request(Request::GoOn) : cut();
  };
  hooks.trouble = [&](const Trouble& trouble) {
    told.push_back(trouble);
    held = 20;
    return true;
  };
  one.play(hooks);
  ASSERT_EQ(told.size(), 1u);
  EXPECT_THAT(told[0].what, HasSubstr("refresh rate changed"));
  EXPECT_THAT(told[0].mend, HasSubstr("fix the refresh rate"));
  EXPECT_EQ(one.row().state, "done") << "a trial that may go on is shown again";
  EXPECT_EQ(std::count(one.person.seen.begin(), one.person.seen.end(), "trouble"), 1);
}

TEST(Repeats, NothingIsShownBeforeAnEyeTrackerSeesTheEyes) {
  for (const bool silent : {false, true}) {
    Flashing one;
    one.eyes.silent = silent;
    one.closed = [] { return true; };
    EXPECT_THROW(one.play(one.cut_by(CutCause::Experimenter, 3)), Stopped);
    EXPECT_EQ(one.count("presentation"), 0) << "it was shown without gaze";
    EXPECT_THAT(one.events("paused by the program"),
                ::testing::Each("the eye tracker does not see the eyes"));
    EXPECT_EQ(one.events("paused by the program").size(), 3u);
    // Valid gaze is not required of a participant who refuses its recording.
    Flashing other;
    other.eyes.silent = silent;
    other.closed = [] { return true; };
    other.person.says[gaze_question] = test::score(0);
    other.play({});
    EXPECT_EQ(other.count("presentation WHERE state = 'played'"), 2);
  }
}

TEST(Repeats, AfterACutForWantOfGazeTheEyesMustBeSeenAgain) {
  Flashing one;
  bool gone = false;
  one.closed = [&] { return gone = gone || one.lamp.lit(); };
  SessionHooks hooks;
  hooks.request = [&] {
    const bool endless = one.lamp.turns_ns.size() > 40;
    return one.sitting.troubles < 2 && !endless ? Request::GoOn : Request::Stop;
  };
  EXPECT_THROW(one.play(hooks), Stopped);
  EXPECT_EQ(one.lamp.turns_ns.size(), 2u) << "it was shown to eyes that are not seen";
  EXPECT_THAT(one.events("paused by the program"),
              ElementsAre("the eye tracker does not see the eyes", "the eye tracker does not see the eyes"));
}

TEST(Repeats, WhyASourceOfGazeIsSilentStandsInTheNoteAndOnThePause) {
  Flashing one;
  bool gone = false;
  one.closed = [&] {
    gone = gone || one.lamp.lit();
    one.eyes.silent = gone;
    one.eyes.why = gone ? "the sender is gone" : "";
    return false;
  };
  SessionHooks hooks;
  std::vector<Trouble> told;
  hooks.trouble = [&](const Trouble& trouble) {
    told.push_back(trouble);
    return false;
  };
  hooks.request = [&] { return told.empty() ? Request::GoOn : Request::Stop; };
  EXPECT_THROW(one.play(hooks), Stopped);
  EXPECT_THAT(one.events("trial interrupted"),
              ElementsAre("the eye tracker lost the eyes for over 100 ms: the sender is gone"));
  EXPECT_THAT(one.events("paused by the program"), ElementsAre("the sender is gone"));
  ASSERT_EQ(told.size(), 1u);
  EXPECT_THAT(told[0].mend, HasSubstr("start the eye tracker's sender again"));
}

}  // namespace
}  // namespace study
