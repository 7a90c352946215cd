#pragma once
/// Sessions without pictures on the virtual clock, with scripted participants, for tests.

#include <cmath>
#include <filesystem>
#include <functional>
#include <map>
#include <memory>
#include <sstream>
#include <string>
#include <vector>

#include "libstudy/display/null.hpp"
#include "libstudy/observer/observer.hpp"
#include "libstudy/session/session.hpp"
#include "libstudy/store/read/status.hpp"
#include "tests/libstudy/study_fixture.hpp"

namespace study::test {

/// Returns the same stimulus, which draws nothing, for all cells. Records the methods of the cells.
class NullStimuli final : public StimulusSource {
 public:
  explicit NullStimuli(double content_step_s) : stimulus_(content_step_s) {}
  Stimulus& stimulus(const Cell& cell) override {
    asked.push_back(cell.stimulus.method);
    return stimulus_;
  }
  std::vector<std::string> asked;

 private:
  NullStimulus stimulus_;
};

/// The parts of a session on the virtual clock, except the participant and the store.
struct Desk {
  explicit Desk(const Protocol& protocol) : stimuli(protocol.content.content_step_s) {}
  SessionParts parts(Participant& participant, Store& store) {
    return {clock, display, stimuli, participant, store, nullptr, true};
  }
  VirtualClock clock;
  NullDisplay display;
  NullStimuli stimuli;
};

inline std::unique_ptr<Observer> ptpe_observer() {
  static FeatureTable features;
  return make_observer("ptpe:a=31,b=0.035", features);
}

/// A participant with scripted answers: `says` has the answer of a question; any other question is answered
/// by 1.
class Scripted final : public Participant {
 public:
  std::optional<std::string> simulated() const override { return "scripted"; }
  void read(const Block& block, double least_s, Clock& clock, const Check& check) override {
    seen.push_back("read " + block.id);
    wait(least_s, clock, check);
  }
  std::vector<TimedAnswer> ask(const Block&, std::span<const Question> questions, const Occasion& occasion,
                               Clock&, const Check& check) override {
    check();
    std::vector<TimedAnswer> out;
    std::string line = "ask";
    for (const Question& question : questions) {
      line += " " + question.id;
      const auto found = says.find(question.id);
      out.push_back({found == says.end() ? score(1) : found->second, 0.5});
    }
    seen.push_back(line);
    occasions.push_back(occasion);
    return out;
  }
  void pause(const Pause& pause, Clock& clock, const Check& check) override {
    const char* names[] = {"black", "rest", "break", "first", "second", "held", "trouble"};
    if (pause.seconds > 0.02 || pause.over || pause.kind == PauseKind::Trouble) {
      seen.push_back(names[static_cast<int>(pause.kind)] + in_seconds(pause.seconds));
      if (!pause.title.empty() || !pause.text.empty()) seen.back() += " '" + pause.title + "' " + pause.text;
    }
    do wait(pause.over ? 0.1 : pause.seconds, clock, check);
    while (pause.over && !pause.over());
  }
  void tell(Notice notice, double least_s, Clock& clock, const Check& check) override {
    const char* names[] = {"over", "refused", "not eligible", "kept", "deleted", "goodbye"};
    seen.push_back("tell " + std::string(names[static_cast<int>(notice)]) + in_seconds(least_s));
    wait(least_s, clock, check);
  }
  bool offer(Offer offer, Clock&, const Check& check) override {
    const char* names[] = {"stay out", "questionnaire", "keep"};
    seen.push_back("offer " + std::string(names[static_cast<int>(offer)]));
    check();
    return !decides || decides(offer);
  }

  std::function<bool(Offer)> decides;  ///< empty: accepts every offer
  std::map<std::string, Answer> says;
  std::vector<std::string> seen;
  std::vector<Occasion> occasions;

 private:
  /// " 0.5" for 0.5 s; empty for 0 s.
  static std::string in_seconds(double seconds) {
    std::ostringstream text;
    if (seconds > 0) text << ' ' << seconds;
    return text.str();
  }
  static void wait(double seconds, Clock& clock, const Check& check) {
    check();
    clock.wait_until(clock.now_ns() + std::llround(1e9 * seconds));
    check();
  }
};

/// The protocol `text` of pairs with 20 frames/s for all stimuli, and with a rest between a trial's two
/// questions.
inline Protocol paced(const std::string& text) {
  return parse_protocol(replaced(with_keys(text, {{"timing", "\"equal\"\nmean_fps = [20]\nsd_fps = [0]"}}),
                                 "\"ask preference ease\"", "\"ask preference\", \"rest 9\", \"ask ease\""),
                        "pairs.toml");
}

/// pairs() changed by paced(). `policy`: the value of on_interruption; `more`: further blocks.
inline Protocol paced_pairs(const std::string& policy = "", const std::string& more = "") {
  const std::string text = pairs_text() + more, judge = "id = \"judge\"\n";
  return paced(policy.empty() ? text
                              : replaced(text, judge, judge + "on_interruption = \"" + policy + "\"\n"));
}

/// pairs.toml changed by paced(), with a consent page that asks only whether the person takes part.
inline Protocol consented() { return paced(without(protocol_text("pairs"), {"gaze_kept", "data_shared"})); }

/// One session of a protocol in its own database.
struct OneSession {
  explicit OneSession(const Protocol& asked) : protocol(asked), desk(asked) {
    store.add_run(run_plan(protocol, {"P01"}));
    person.says["age"] = score(40);
    person.says["remarks"] = words("");
  }
  std::vector<OpenRun> open() { return store.open_runs(); }
  std::optional<Ending> run(const SessionHooks& hooks = {}) {
    SessionParts parts = desk.parts(person, store);
    parts.personal = &personal;
    const auto runs = open();
    return run_session(protocol, runs.at(0).sessions.at(0), parts, hooks);
  }
  std::int64_t count(const std::string& sql) {
    return sqlite::Connection(folder / "study.db", sqlite::Open::Read).integer("SELECT count(*) FROM " + sql);
  }
  SessionRow row() { return read_status(folder / "study.db").sessions.at(0); }

  TemporaryFolder folder;
  Protocol protocol;
  Desk desk;
  Store store{folder / "study.db", sqlite::Open::Create};
  PersonalFile personal{folder / "study.db"};
  Scripted person;
};

/// Makes `request` after frame 5 of each of the first `showings` showings.
inline SessionHooks wish_at_frame_5(Request request, int showings) {
  auto frame = std::make_shared<std::int64_t>(-1);
  auto left = std::make_shared<int>(showings);
  SessionHooks hooks;
  hooks.shown = [frame](const FrameRecord& record) { *frame = record.index; };
  hooks.request = [=]() -> Request {
    if (*frame != 5 || *left == 0) return Request::GoOn;
    *frame = -1;
    --*left;
    return request;
  };
  return hooks;
}

}  // namespace study::test
