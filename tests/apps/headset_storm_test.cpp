/// Storms: sessions in the simulated headset while its runtime does two hundred things at random. Whatever
/// happens, the session comes to its end, nothing flashes, no slot is missing, and each cut has one cause.
#include <random>
#include <sstream>

#include "libstudy/headset/headset_recorder.hpp"
#include "libstudy/runner/session_setup.hpp"
#include "tests/apps/headset_runs.hpp"
#include "tests/libstudy/permission_fixture.hpp"
#include "tests/libstudy/session_fixture.hpp"

namespace apps {
namespace {

constexpr int first_event = 60, most_events = 200;
/// A session that makes no progress is ended at this frame, and its test fails.
constexpr int last_frame = 20000;

/// What a runtime may do, with the values from which one is drawn.
struct Happening {
  std::string name;
  std::vector<double> values;
};
const std::vector<Happening> happenings{
    {"focus", {0, 1}},         {"shown", {0, 1}},          {"render", {0, 1}},
    {"off", {0.05, 0.4, 1.5}}, {"worn", {0, 1}},           {"drop", {1, 3, 34}},
    {"skips", {0, 0, 1, 2}},   {"recentre", {-40, 0, 25}}, {"rate", {72, 80, 90, 120}},
    {"rate_untold", {72, 90}}, {"jitter", {0, 0, 1}},      {"repeat", {1}},
    {"orientation", {0, 1}},   {"position", {0, 1}},       {"events_lost", {1}},
    {"unknown", {1}},          {"gaze_valid", {0, 1}},     {"gaze_active", {0, 1}},
    {"gaze_age", {0, 30}},     {"blink_every", {0, 0.7}}};

/// A script of `most_events` events, most of them random, after which all is well again. A session is lost
/// twice at most.
std::string storm(unsigned seed) {
  std::mt19937 random(seed);
  const auto below = [&random](std::size_t count) { return random() % count; };
  std::ostringstream script;
  int frame = first_event, event = 0;
  script << "at=";
  // While the first page is on, the room is recentred eighteen times a second.
  for (; event < 20; ++event) script << (frame += 5) << ":recentre/5,";
  for (; event < most_events; ++event) {
    frame += static_cast<int>(below(12) == 0 ? 40 + below(90) : below(5) == 0 ? below(30) : below(4));
    const auto& [name, values] = happenings[below(happenings.size())];
    script << frame << ':' << name << '/' << values[below(values.size())] << ',';
    if (event == 70 || event == 140) script << frame << ":lost_now,";
  }
  for (const char* well :
       {"focus/1", "worn/1", "render/1", "orientation/1", "position/1", "skips/0", "jitter/0", "gaze_valid/1",
        "gaze_active/1", "gaze_age/0", "blink_every/0", "rate/90"})
    script << frame + 1 << ':' << well << ',';
  script << last_frame << ":exit";
  return script.str();
}

/// A person who reads, answers and goes on after each pause. Each page of questions is on for 2 s. As a
/// person's pages are, it is shown again wherever the headset took it away.
class Patient final : public study::Participant {
 public:
  explicit Patient(study::HeadsetDisplay& display) : display_(display) {}
  std::optional<std::string> simulated() const override { return {}; }
  void read(const study::Block&, double least_s, study::Clock& clock, const study::Check& check) override {
    wait(least_s, clock, check);
  }
  std::vector<study::TimedAnswer> ask(const study::Block&, std::span<const study::Question> questions,
                                      const study::Occasion&, study::Clock& clock,
                                      const study::Check& check) override {
    const Page page(display_);
    for (int part = 0; part < 100; ++part) {
      page.show();
      wait(0.02, clock, check);
    }
    return {questions.size(), study::TimedAnswer{study::test::score(1), 0.1}};
  }
  void pause(const study::Pause& pause, study::Clock& clock, const study::Check& check) override {
    wait(pause.seconds, clock, check);
  }

 private:
  struct Page {
    explicit Page(study::HeadsetDisplay& on) : display(on) {}
    ~Page() { display.hide_page(); }
    Page(const Page&) = delete;
    Page& operator=(const Page&) = delete;
    void show() const {
      study::HeadsetPage page;
      page.pose.place_m = {0, 0, -1};
      page.width_m = page.height_m = 0.5F;
      display.page();
      display.show_page(page);
    }
    study::HeadsetDisplay& display;
  };

  static void wait(double seconds, study::Clock& clock, const study::Check& check) {
    check();
    clock.wait_until(clock.now_ns() + std::llround(1e9 * seconds));
    check();
  }

  study::HeadsetDisplay& display_;
};

class HeadsetStorm : public test::HeadsetRuns {
 protected:
  /// The time of each frame of the runtime's log, on the session's clock. Nothing flashes in them: light
  /// follows black three times at most within a second.
  std::vector<std::int64_t> frames_without_flashes() const {
    constexpr std::int64_t ahead_of_monotonic = 1'000'000'000'000;
    std::vector<std::int64_t> frames, onsets;
    bool lit = false;
    std::istringstream lines(calls());
    for (std::string line; std::getline(lines, line);) {
      EXPECT_THAT(line, ::testing::Not(::testing::StartsWith("BREACH")));
      if (line.starts_with("state STOPPING") || line.starts_with("state LOSS")) lit = false;
      if (!line.starts_with("frame ")) continue;
      frames.push_back(std::stoll(line.substr(line.find("predicted ") + 10)) - ahead_of_monotonic);
      const bool now = line.find(" render 1 layers 0") == std::string::npos &&
                       line.find(" render 1 ") != std::string::npos;
      if (now && !lit) onsets.push_back(frames.back());
      lit = now;
    }
    for (std::size_t i = 3; i < onsets.size(); ++i)
      EXPECT_GE(onsets[i] - onsets[i - 3], 1'000'000'000) << "four flashes at " << onsets[i];
    return frames;
  }

  /// Each cut showing has one event that names one cause, and so does each note. Where slots were stored,
  /// they are the runtime's, none is missing, and a whole showing has some.
  void expect_accounts(const std::string& path, const std::vector<std::int64_t>& frames) const {
    using ::testing::IsEmpty;
    const auto rows = [&](const std::string& sql) { return study::test::column(path, sql); };
    EXPECT_THAT(rows("SELECT presentation_id FROM presentation p WHERE state = 'running' OR (state = "
                     "'interrupted') <> (SELECT count(*) FROM event e WHERE e.presentation_id = "
                     "p.presentation_id AND kind = 'trial interrupted')"),
                IsEmpty());
    for (const std::string& words :
         rows("SELECT detail FROM event WHERE kind = 'trial interrupted' UNION ALL SELECT words FROM note")) {
      int causes = 0;
      for (int cause = 0; cause <= static_cast<int>(study::CutCause::Last); ++cause)
        causes += words.starts_with(study::words_of(static_cast<study::CutCause>(cause)).happened);
      EXPECT_EQ(causes, 1) << words;
    }
    EXPECT_THAT(rows("SELECT presentation_id FROM presentation p WHERE state = 'played' AND NOT EXISTS "
                     "(SELECT 1 FROM slot s WHERE s.presentation_id = p.presentation_id)"),
                IsEmpty());
    auto from = frames.begin();
    std::string showing;
    study::sqlite::Connection database(path, study::sqlite::Open::Read);
    study::sqlite::Statement row(database,
                                 "SELECT presentation_id, start_ns + s.predicted_ns FROM slot s JOIN "
                                 "presentation USING (presentation_id) ORDER BY 1, slot_index");
    while (row.step()) {
      const std::int64_t at_ns = row.integer(1);
      if (row.text(0) != showing) from = std::find(from, frames.end(), at_ns);
      // A time that was predicted twice may begin a showing the second time.
      if (row.text(0) != showing && from != frames.end() && from + 1 != frames.end() && from[1] == at_ns)
        begins_twice_ = at_ns;
      showing = row.text(0);
      if (from != frames.end() && *from != at_ns && from[-1] == begins_twice_) ++from;
      ASSERT_NE(from, frames.end()) << "showing " << showing << ": a slot that the runtime never had";
      ASSERT_EQ(*from, at_ns) << "showing " << showing << ": a slot is missing before this one";
      ++from;
    }
    EXPECT_THAT(rows("SELECT b.headset_id FROM headset a JOIN headset b ON b.headset_id = a.headset_id + 1 "
                     "WHERE a.refresh_told_hz = b.refresh_told_hz AND abs(a.refresh_measured_hz / "
                     "b.refresh_measured_hz - 1) < .005"),
                IsEmpty())
        << "two rows of headset for one rate in force";
  }

  void sit_through(unsigned seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    if (std::filesystem::exists(log())) std::filesystem::resize_file(log(), 0);
    use_here("size=32x32;presence=1;" + storm(seed));
    const bool holds = seed % 2 == 0;
    std::string text = test::with_keys(test::asking_at_60(), {{"duration_s", "3"}});
    if (holds) text += "\n[headset]\nrefresh_hz = 90\n";
    study::test::OneSession one(study::parse_protocol(text, "asking.toml"));
    {
      const study::HeadsetChoice choice{.eye_gaze = true, .page_width_px = 32, .page_height_px = 32};
      study::HeadsetDisplay display(study::SlotDrive::Caller, choice, one.protocol.headset);
      study::HeadsetClock clock(display);
      study::HeadsetRecorder recorder(display, study::GazeOrigin::Tracker);
      Patient person(display);
      study::SessionParts parts{clock, display, one.desk.stimuli, person, one.store, &one.personal, true};
      parts.gaze = &recorder;
      parts.slots = &recorder;
      study::SessionHooks hooks;
      hooks.request = [requests = study::headset_requests(display)] {
        return requests([] { return study::Request(study::Request::GoOn); });
      };
      const auto runs = one.open();
      ASSERT_NO_THROW(run_session(one.protocol, runs.at(0).sessions.at(0), parts, hooks));
    }
    EXPECT_EQ(one.row().state, "done");
    // A change of the rate between showing and answer sets a whole showing aside.
    EXPECT_EQ(
        one.count("trial t JOIN presentation p USING (trial_id) WHERE p.state = 'played' AND p.attempt > "
                  "t.set_aside"),
        2);
    const auto frames = frames_without_flashes();
    EXPECT_GT(frames.size(), 1000u);
    expect_accounts(one.folder / "study.db", frames);
  }

 private:
  mutable std::int64_t begins_twice_ = 0;
};

class HeadsetStormGl : public HeadsetStorm {};
class HeadsetStormSlow : public HeadsetStorm {};

TEST_F(HeadsetStormGl, TheSessionEndsNothingFlashesNoSlotIsMissingAndEachCutHasOneCause) { sit_through(1); }

TEST_F(HeadsetStormSlow, FortyStormsEndAsWell) {
  for (unsigned seed = 2; seed < 42; ++seed) sit_through(seed);
}

}  // namespace
}  // namespace apps
