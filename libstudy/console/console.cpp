#include "libstudy/console/console.hpp"

#include <fmt/core.h>
#include <algorithm>
#include <cmath>

#include "libstudy/console/console_text.hpp"
#include "libstudy/store/names.hpp"
#include "stats/base/file.hpp"
#include "stats/base/text.hpp"

namespace study {

namespace {

using Guard = std::lock_guard<std::mutex>;

constexpr std::size_t strip_length = 60;
constexpr std::int64_t strip_ns = 500'000'000;
constexpr std::size_t most_typed = 500;  // longest text that can be typed, bytes

/// Removes the incomplete UTF-8 character that the limit of most_typed bytes may leave at the end.
std::string whole_letters(std::string words) {
  for (int i = 0; i < 3 && words.size() + 3 > most_typed && !base::is_plain_line(words); ++i)
    words.pop_back();
  return words;
}

}  // namespace

char strip_sign(double shown_s, double scheduled_s) {
  const double ratio = shown_s > 0 ? scheduled_s / shown_s : 0;  // realised frame rate / scheduled frame rate
  if (std::abs(ratio - 1) <= 0.02) return '.';
  if (std::abs(ratio - 1) > 0.2) return '!';
  return ratio > 1 ? '+' : '-';
}

Console::Console(const Protocol& protocol, Store& store, std::filesystem::path database, Idle idle,
                 std::vector<double> showing_s)
    : protocol_(protocol),
      store_(store),
      database_(std::move(database)),
      idle_(std::move(idle)),
      showing_s_(std::move(showing_s)) {}

void Console::begin(const OpenSession& session) {
  const Guard guard(mutex_);
  session_ = &session;
  unit_.reset();
  last_trial_.reset();
  done_ = 0;
  paused_ = ended_ = repeat_ = false;
  asking_ = Asking::Nothing;
  warnings_.clear();
  trouble_.reset();
  ending_.reset();
  verdicts_.clear();
  say(fmt::format("{}: {} steps of {} left, {}; disk {:.1f} GB free", session.plan.participant,
                  session.units.size(), session.planned, left(), 1e-3 * free_mb(database_)));
  // Names no hypothesis: a plan file lists them. vip-stats reads that file, a session does not.
  say("gaze: " + session.plan.gaze_source +
      (protocol_.needs_gaze && session.plan.gaze_source != "tracked"
           ? "; hypotheses that need tracked gaze are not testable"
           : ""));
  say("keys: p pause, r repeat, x exclude, n note, e end, m method and setting, ? help");
}

void Console::begins(const OpenUnit& unit) {
  const Guard guard(mutex_);
  unit_ = unit;
  unit_done_ = false;
  course_ = {};
  page_since_ns_ = steady_ns();
  say(describe(unit) + "; left: " + left());
}

void Console::ends(const Ending& ending) {
  const Guard guard(mutex_);
  ending_ = ending;
  page_since_ns_ = steady_ns();
  say("the session ended early: " + ending.reason);
}

void Console::warn(const std::string& alarm) {
  const Guard guard(mutex_);
  warnings_.push_back(alarm);
}

void Console::shown(const FrameRecord& frame) {
  const Guard guard(mutex_);
  Course& c = course_;
  if (frame.index == 0) {
    c = {};
    c.first_scheduled_ns = c.strip_scheduled_ns = frame.scheduled_ns;
    c.first_shown_ns = c.strip_shown_ns = frame.times.submitted_ns;
  }
  page_since_ns_ = steady_ns();
  ++c.frames;
  c.late += frame.late ? 1 : 0;
  c.last_scheduled_ns = frame.scheduled_ns;
  c.last_shown_ns = frame.times.submitted_ns;
  c.worst_late_ms =
      std::max(c.worst_late_ms, 1e-6 * static_cast<double>(c.last_shown_ns - c.last_scheduled_ns));
  if (c.last_scheduled_ns - c.strip_scheduled_ns < strip_ns) return;
  c.strip += strip_sign(static_cast<double>(c.last_shown_ns - c.strip_shown_ns),
                        static_cast<double>(c.last_scheduled_ns - c.strip_scheduled_ns));
  if (c.strip.size() > strip_length) c.strip.erase(0, 1);
  c.strip_scheduled_ns = c.last_scheduled_ns;
  c.strip_shown_ns = c.last_shown_ns;
}

void Console::done(const UnitDone& unit) {
  const Guard guard(mutex_);
  ++done_;
  unit_done_ = true;
  if (unit_ && unit_->trial) {
    last_trial_ = unit_;
    last_trial_->attempts = unit.attempt;
    verdicts_ = unit.verdicts;
  }
  for (const TimingVerdict& verdict : unit.verdicts) say("  " + describe(verdict));
  // If repeat_ is still set, the trial ended before request() could cut it for the repeat.
  if (std::exchange(repeat_, false)) show_at_the_end(*last_trial_);
}

Request Console::request() {
  const Guard guard(mutex_);
  if (ended_) return Request::EndSession;
  if (std::exchange(repeat_, false)) return CutCause::Experimenter;
  return paused_ ? Request::Pause : Request::GoOn;
}

bool Console::take_reopened() {
  const std::lock_guard acting(acting_);
  const Guard guard(mutex_);
  if (!reopened_) session_ = nullptr;
  return std::exchange(reopened_, false);
}

void Console::key(char byte) {
  const std::lock_guard acting(acting_);
  std::optional<Deed> deed;
  {
    const Guard guard(mutex_);
    read(byte);
    deed = std::exchange(deed_, {});
  }
  if (deed) carry_out(*deed);
}

/// Stores a change and confirms it. Does not lock mutex_ during the disk access, because shown() waits for
/// mutex_ at each frame.
void Console::carry_out(const Deed& deed) {
  try {
    deed.store();
  } catch (const std::exception& error) {
    const std::string why = error.what();
    const Guard guard(mutex_);
    warnings_.push_back("NOT KEPT: " + deed.what + " (" + why.substr(0, why.find('\n')) + ")");
    return say(warnings_.back());
  }
  const Guard guard(mutex_);
  deed.then();
}

void Console::read(char byte) {
  if (asking_ == Asking::Nothing) return command(byte);
  if (byte == '\n' || byte == '\r') return enter();
  if (byte == 27) {  // Esc
    asking_ = Asking::Nothing;
    return say("(nothing was done)");
  }
  if (byte == 127 || byte == 8) {
    // Removes a UTF-8 character as a whole.
    while (!typed_.empty() && (static_cast<unsigned char>(typed_.back()) & 0xC0) == 0x80) typed_.pop_back();
    if (!typed_.empty()) typed_.pop_back();
    return;
  }
  if (static_cast<unsigned char>(byte) >= 32 && typed_.size() < most_typed) typed_ += byte;
}

void Console::command(char byte) {
  if (!session_) return;
  const OpenUnit* trial = unit_ && unit_->trial ? &*unit_ : last_trial_ ? &*last_trial_ : nullptr;
  switch (byte) {
    case 'p':
      paused_ = !paused_;
      trouble_.reset();
      return say(paused_ ? "PAUSE before the next step; p goes on" : "goes on");
    case 'n':
      return ask(Asking::Note, "note: ");
    case 'r':
      return trial ? ask(Asking::Repeat, fmt::format("repeat trial {}, reason: ", trial->trial->position + 1))
                   : say("no trial to repeat");
    case 'x':
      return trial
                 ? ask(Asking::Exclude, fmt::format("exclude trial {}, reason: ", trial->trial->position + 1))
                 : say("no trial to exclude");
    case 'e':
      return ask(Asking::End, "end the session (a rest, then the exit)? write yes: ");
    case 'm':
      return reveal();
    case '?':
    case 'h':
      say("p  pause before the next step, and go on     n  note, with its time");
      say("r  repeat this trial, or the last one        x  exclude it from analyses");
      say("e  end the session: a rest, then the exit    m  show or hide method and setting (logged)");
      return;
    default:
      return;
  }
}

void Console::ask(Asking what, const std::string& prompt) {
  asking_ = what;
  prompt_ = prompt;
  typed_.clear();
}

void Console::enter() {
  const Asking asked = std::exchange(asking_, Asking::Nothing);
  const std::string words = whole_letters(std::exchange(typed_, {}));
  if (!session_) return say("(nothing was done: the session is over)");
  if (words.find_first_not_of(' ') == std::string::npos) return say("(nothing was done: nothing was typed)");
  if (!base::is_plain_line(words)) return say("(nothing was done: these words are not UTF-8)");
  if (asked == Asking::Note) return note(words);
  if (asked == Asking::Repeat) return repeat(words);
  if (asked == Asking::Exclude) return exclude(words);
  if (words != "yes") return say("(the session goes on)");
  ended_ = true;
  say("ending the session: a rest first; the participant leaves only when well");
}

void Console::note(const std::string& words) {
  const std::int64_t session = session_->id;
  const std::optional<std::int64_t> unit = unit_ ? std::optional(unit_->id) : std::nullopt;
  const std::string timed = clock_time() + " " + words;
  keep(
      "note: " + words, [=, this] { store_.note(session, unit, timed); },
      [=, this] { say("noted: " + words); });
}

/// Reopens a trial: the trial that is running or, if none is, the trial that finished last. Reopens it in the
/// database at once, so that it is shown again even if this program ends before that showing.
void Console::repeat(const std::string& reason) {
  const std::int64_t session = session_->id;
  const OpenUnit trial = unit_ && unit_->trial && !unit_done_ ? *unit_ : *last_trial_;
  keep(
      fmt::format("repeat of trial {}: ", trial.trial->position + 1) + reason,
      [=, this] { store_.repeat_trial(session, trial.trial_id, reason); },
      [=, this] {
        if (unit_done_ || unit_->trial_id != trial.trial_id) return show_at_the_end(trial);
        repeat_ = true;
        say(fmt::format("trial {} is shown again, from its start", trial.trial->position + 1));
      });
}

void Console::show_at_the_end(const OpenUnit& trial) {
  reopened_ = true;
  say(fmt::format("trial {} is shown again at the end of the session", trial.trial->position + 1));
}

void Console::exclude(const std::string& reason) {
  const OpenUnit trial = unit_ && unit_->trial ? *unit_ : *last_trial_;
  const std::int64_t session = session_->id;
  keep(
      fmt::format("exclusion of trial {}: ", trial.trial->position + 1) + reason,
      [=, this] { store_.exclude_trial(session, trial.trial_id, reason); },
      [=, this] {
        say(fmt::format("trial {} is excluded from analyses; its data stay", trial.trial->position + 1));
      });
}

void Console::reveal() {
  const std::int64_t session = session_->id;
  const bool shows = !revealed_;
  keep(
      shows ? "that method and setting are shown" : "that method and setting are hidden",
      [=, this] { store_.log(session, shows ? revealed_event : "setting hidden", "to the experimenter"); },
      [=, this] {
        revealed_ = shows;
        if (!shows) return say("method and setting are hidden again");
        say(unit_ && unit_->trial ? "revealed (logged): " + describe_cells(*unit_->trial)
                                  : "revealed (logged)");
      });
}

void Console::say(const std::string& line) { lines_.push_back(clock_time() + "  " + line); }

void Console::keep(std::string what, std::function<void()> store, std::function<void()> then) {
  deed_ = Deed{std::move(what), std::move(store), std::move(then)};
}

std::vector<std::string> Console::take_lines() {
  const Guard guard(mutex_);
  return std::exchange(lines_, {});
}

}  // namespace study
