#include "libstudy/session/session.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>

#include "libstudy/session/farewell.hpp"
#include "libstudy/session/recording.hpp"
#include "libstudy/session/running.hpp"
#include "libstudy/session/trial_player.hpp"
#include "stats/base/error.hpp"

namespace study {

namespace {

/// Times at each target, s: settle_s for a saccade and for the eyes to settle, then sample_s in which the
/// gaze samples are used.
constexpr double settle_s = 0.8, sample_s = 1;

/// Positions (x, y) of the targets as multiples of Block::extent_deg. The first target is in the middle and
/// the second in a corner. Each later target is a neighbour of the target before, because a longer saccade
/// would need a longer settle_s.
constexpr std::array<std::array<int, 2>, 9> grid{
    {{0, 0}, {-1, 1}, {0, 1}, {1, 1}, {1, 0}, {1, -1}, {0, -1}, {-1, -1}, {-1, 0}}};

class Targets {
 public:
  explicit Targets(GazeTargets& targets) : targets_(targets) { targets_.begin(); }
  ~Targets() { targets_.end(); }
  Targets(const Targets&) = delete;
  Targets& operator=(const Targets&) = delete;

 private:
  GazeTargets& targets_;
};

std::vector<ValidatedPoint> look_at_all(const Running& run, const Block& block, const Check& check) {
  const Targets shown(*run.parts.targets);
  std::vector<ValidatedPoint> points;
  for (const auto& [x, y] : grid) {
    ValidatedPoint point;
    point.azimuth_deg = x * block.extent_deg;
    point.elevation_deg = y * block.extent_deg;
    const auto samples =
        run.parts.targets->look_at(point.azimuth_deg, point.elevation_deg, settle_s, sample_s, check);
    point.clock_ns = run.now_ns() - static_cast<std::int64_t>(sample_s * 1e9);
    const GazeQuality quality = gaze_quality(samples);
    point.samples = quality.samples;
    point.valid = quality.valid;
    point.accuracy_deg = quality.accuracy_deg;
    point.sd_deg = quality.sd_deg;
    point.rms_s2s_deg = quality.rms_s2s_deg;
    points.push_back(point);
  }
  return points;
}

/// Mean error over the targets, degrees; none if a target had no valid sample.
std::optional<double> mean_accuracy(const std::vector<ValidatedPoint>& points) {
  double sum = 0;
  for (const ValidatedPoint& point : points) {
    if (!point.accuracy_deg) return {};
    sum += *point.accuracy_deg;
  }
  return sum / static_cast<double>(points.size());
}

std::string in_degrees(const char* form, double value) {
  std::array<char, 160> text{};
  std::snprintf(text.data(), text.size(), form, value);
  return text.data();
}

/// Shows nine targets and stores the eye tracker's accuracy and precision at each target. A try fails if the
/// mean error exceeds Block::max_accuracy_deg or a target had no valid sample; then it is repeated, up to
/// Block::count tries. Without a tracker or permission to record gaze, shows nothing and logs the reason.
/// base::Error if the last try fails too; all tries are then stored and the unit stays open.
void validate_gaze(const Running& run, const Block& block, const Check& check) {
  Store& store = run.parts.store;
  if (!run.parts.targets || !store.allows_gaze(run.session.id)) {
    store.log(run.session.id, "gaze not validated",
              run.parts.targets ? "recording gaze is not allowed" : "no eye tracker is read", run.now_ns());
    return;
  }
  std::optional<double> mean;
  for (int tries = 0; tries < block.count; ++tries) {
    const auto points = look_at_all(run, block, check);
    mean = mean_accuracy(points);
    const bool passed = mean && (!block.max_accuracy_deg || *mean <= *block.max_accuracy_deg);
    store.add_validation(run.session.id, points, passed);
    if (passed) return;
  }
  throw base::Error("block " + block.id,
                    mean ? in_degrees("the eye tracker is off by %.2f degrees in the mean, ", *mean) +
                               in_degrees("more than the protocol's %.2f", block.max_accuracy_deg.value_or(0))
                         : "the eye tracker does not see the eyes at every target",
                    "calibrate it in the headset's software and continue with vip-study resume");
}

class SessionRun {
 public:
  explicit SessionRun(const Running& run) : run_(run), questioning_(run), trials_(run, questioning_) {}

  /// Runs all units that are not done. Returns the ending if the session ended early; the ending is then
  /// committed.
  std::optional<Ending> go() {
    try {
      return units();
    } catch (const Ending& wished) {
      return end(wished);
    } catch (const Left& left) {
      return end({EarlyEnd::DroppedOut, left.what()});
    }
  }

  void say_farewell(const Ending& ending) {
    study::say_farewell(run_, questioning_, ending, std::span(run_.session.units).subspan(under_way_));
  }

 private:
  std::optional<Ending> units() {
    for (under_way_ = 0; under_way_ < run_.session.units.size(); ++under_way_) {
      const OpenUnit& unit = run_.session.units[under_way_];
      wait_while_paused();
      run_.marking.enter(unit.plan.position, 0);
      if (run_.hooks.begins) run_.hooks.begins(unit);
      if (auto ends = unit.trial ? trials_.play(unit) : page(unit)) return ends;
    }
    return {};
  }

  Ending end(const Ending& ending) {
    run_.parts.store.end_session(run_.session.id, ending, run_.now_ns());
    return ending;
  }

  void wait_while_paused() {
    const auto check = [this] { poll_requests(run_, false); };
    check();
    const auto over = [this] { return run_.request() != Request::Pause; };
    if (!over()) pause({PauseKind::Held, 0, {}, {}, over}, check);
  }

  std::optional<Ending> page(const OpenUnit& unit) {
    const Block& block = run_.block(unit);
    const Check check = [this] { poll_requests(run_, false); };
    switch (block.kind) {
      case BlockKind::Instructions:
      case BlockKind::Debrief:
        run_.parts.participant.read(block, block.seconds, run_.parts.clock, check);
        break;
      case BlockKind::Rest:
        pause({PauseKind::Rest, block.seconds, block.title, block.text}, check);
        break;
      case BlockKind::Break:
        pause({PauseKind::Break, block.seconds, block.title, block.text}, check);
        break;
      case BlockKind::Black:
        pause({PauseKind::Black, block.seconds}, check);
        break;
      case BlockKind::GazeValidation:
        validate_gaze(run_, block, check);
        break;
      case BlockKind::Stimulus:  // between two groups, or after every break_every trials
        pause({PauseKind::Break, block.between_groups_s + block.break_s}, check);
        break;
      default: {
        auto ends = questioning_.ask(unit, 0, block.questions, run_.occasion(unit), true, check);
        if (!ends || ends->how == EarlyEnd::Stopped) run_.tell(unit, 0, {});
        return ends;
      }
    }
    run_.parts.store.finish_unit(run_.session.id, unit.id, run_.now_ns());
    run_.tell(unit, 0, {});
    return {};
  }

  void pause(const Pause& pause, const Check& check) {
    run_.parts.participant.pause(pause, run_.parts.clock, check);
  }

  const Running& run_;
  Questioning questioning_;
  TrialPlayer trials_;
  std::size_t under_way_ = 0;  ///< index of the current unit
};

void check_personal(const Running& run) {
  const auto all = all_questions(run.protocol);
  const bool asks =
      std::any_of(all.begin(), all.end(), [](const auto& entry) { return entry.second->personal; });
  if (asks && !run.parts.personal) {
    throw base::Error("protocol " + run.protocol.name,
                      "asks personal questions, and there is no file for the answers",
                      "set SessionParts::personal to a file of personal data");
  }
}

}  // namespace

std::optional<Ending> run_session(const Protocol& protocol, const OpenSession& session,
                                  const SessionParts& parts, const SessionHooks& hooks) {
  // The clock of a headset's session is ahead of the computer's by the way of a picture to the display.
  const RealClock real;
  const Clock& marked_by = parts.virtual_clock ? parts.clock : static_cast<const Clock&>(real);
  Marking marking(hooks.mark, marked_by, session.plan.plan.slot);
  MarkedParticipant participant(parts.participant, marking);
  SessionParts marked{parts.clock,    parts.display,       parts.stimuli, participant, parts.store,
                      parts.personal, parts.virtual_clock, parts.gaze,    parts.slots, parts.targets};
  const Running running{protocol, session, marked, hooks, marking};
  check_personal(running);
  record_headset(running);
  record_tracker(running);
  const MarkedSession begun(marking);
  SessionRun run(running);
  const std::optional<Ending> ending = run.go();
  log_tracker(running);
  if (ending && hooks.ends) hooks.ends(*ending);
  if (ending) run.say_farewell(*ending);
  return ending;
}

namespace {

/// Converts counts of display periods to intervals in nanoseconds without accumulating rounding errors.
std::vector<std::int64_t> holds_ns(const std::vector<int>& holds, double refresh_hz) {
  std::vector<std::int64_t> intervals;
  std::int64_t periods = 0, before = 0;
  for (const int hold : holds) {
    periods += hold;
    const std::int64_t now = std::llround(static_cast<double>(periods) * 1e9 / refresh_hz);
    intervals.push_back(now - before);
    before = now;
  }
  return intervals;
}

}  // namespace

std::vector<std::int64_t> trial_intervals(const Protocol& protocol, const FpsSetting& setting,
                                          const Display& display, std::uint64_t schedule_seed) {
  const double refresh_hz = display.refresh_hz();
  const PacingRules rules = for_display(protocol.pacing, refresh_hz);
  if (refresh_hz == 0) return compile_schedule(setting, rules, schedule_seed).intervals_ns;

  const RefreshVerdict found = quantise(setting, rules, refresh_hz, schedule_seed);
  const bool shown = found.feasibility == Feasibility::Exact ||
                     (found.feasibility == Feasibility::Approximate && protocol.accept_approximate);
  if (!shown) {
    const bool near = found.feasibility == Feasibility::Approximate;
    throw base::Error(
        protocol.name + " on " + display.description(),
        "setting " + setting_name(setting) +
            (near ? " can be shown only approximately: " : " cannot be shown: ") + found.reason,
        near ? "use another display, or write accept_approximate = true in the protocol"
             : "use another display or refresh; vip-study check --refresh HZ says what it can show");
  }
  return holds_ns(found.holds, display.measured_hz());
}

void check_settings(const Protocol& protocol, const Display& display) {
  if (protocol.design.timing == TimingSource::Native) return;
  for (const Cell& cell : protocol.design.cells) trial_intervals(protocol, cell.setting, display, 0);
}

}  // namespace study
