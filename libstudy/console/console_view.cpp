/// The part of class Console that describes the session in words.
#include <fmt/core.h>
#include <algorithm>

#include "libstudy/console/console.hpp"
#include "libstudy/console/console_text.hpp"
#include "libstudy/console/progress.hpp"
#include "stats/base/duration.hpp"

namespace study {

namespace {

constexpr double little_disk_mb = 500;
constexpr double long_s = 90;  // after this time on a page without input, an alarm appears, s
constexpr std::int64_t looks_ns = 1'000'000'000;

std::string short_time(double seconds) { return base::duration_words(std::max(0.0, seconds)); }

/// Advice to the experimenter about a participant whose session ended before its last step.
std::string words_of(const Ending& ending) {
  if (ending.how == EarlyEnd::Stopped) return "STOPPED: a rest first; the participant leaves only when well";
  if (ending.how == EarlyEnd::DroppedOut)
    return "LEFT: see to the participant; the answers so far are stored";
  if (ending.how == EarlyEnd::Refused) return "DID NOT CONSENT: nothing more is asked; thank them";
  return "INELIGIBLE: nothing more is asked; thank them";
}

/// The alarm text if a stimulus of the trial was cut because it took too long, else if a timing verdict is
/// Fail; null if neither.
const char* failure_of(const std::vector<TimingVerdict>& verdicts) {
  const char* failure = nullptr;
  for (const TimingVerdict& one : verdicts) {
    if (one.cut) return "CUT because it took too long: the machine is too slow for it";
    if (one.verdict == Verdict::Fail) failure = "timing FAILED";
  }
  return failure;
}

}  // namespace

std::string Console::left() const {
  const auto& units = session_->units;
  const std::size_t done = std::min(done_, units.size());
  return "about " +
         base::duration_words(expected_s(protocol_, std::span(units).subspan(done), true, showing_s_));
}

std::string Console::describe(const OpenUnit& unit) const {
  const Block& block = protocol_.blocks.at(static_cast<std::size_t>(unit.plan.block));
  std::string line = fmt::format("step {} of {}: {} '{}'", unit.plan.position + 1, session_->planned,
                                 block_kind_name(block.kind), block.id);
  if (unit.trial) line += fmt::format(", trial {}", unit.trial->position + 1);
  if (unit.trial && revealed_) line += " (" + describe_cells(*unit.trial) + ")";
  return line;
}

std::string Console::describe_cells(const PlannedTrial& trial) const {
  std::string all;
  for (const auto& index : {std::optional(trial.first), trial.second}) {
    if (!index) continue;
    const Cell& cell = protocol_.design.cells.at(static_cast<std::size_t>(*index));
    if (!all.empty()) all += ", then ";
    all += cell.stimulus.method + " " + cell.stimulus.n_star + " " + cell.stimulus.scene;
    if (!cell.stimulus.effects.empty()) all += ", effects " + cell.stimulus.effects;
    if (!cell.stimulus.surface.empty()) all += ", " + cell.stimulus.surface;
    if (cell.setting.mean > 0) all += " at " + setting_name(cell.setting) + " frames/s";
  }
  return all;
}

/// Describes a showing's timing: verdict, grade, relative deviation of the mean frame rate, late frames and
/// the largest lateness. Adds frame rates and the verdict's reason only while method and setting are
/// revealed. For a showing without a schedule, returns only "no schedule" or the reason of its cut.
std::string Console::describe(const TimingVerdict& verdict) const {
  if (!(verdict.nominal.mean > 0))
    return verdict.cut ? "timing fail: " + verdict.reason : "timing: no schedule";
  std::string line =
      "timing " + verdict_name(verdict.verdict) +
      fmt::format(", grade {}: mean {:+.2f} %, late {}, worst {:.2f} ms", static_cast<char>(verdict.grade),
                  100 * (verdict.realised.mean / verdict.nominal.mean - 1), verdict.late,
                  verdict.worst_late_ms);
  if (revealed_)
    line += fmt::format("; realised {:.2f}, sd {:.2f} frames/s", verdict.realised.mean, verdict.realised.sd);
  if (revealed_ && !verdict.reason.empty()) line += "; " + verdict.reason;
  return line;
}

bool Console::looks(std::int64_t now_ns) const {
  return !unit_done_ && course_.frames > 0 && now_ns - page_since_ns_ < looks_ns;
}

double Console::on_page_s(std::int64_t now_ns) const {
  return 1e-9 * static_cast<double>(now_ns - page_since_ns_);
}

std::string Console::describe_person(std::int64_t now_ns) const {
  if (ending_) return words_of(*ending_);
  if (trouble_ && session_ && !ended_) return "reads that the pictures cannot be shown; PAUSED, p goes on";
  if (!session_) return "none: the session is over";
  if (ended_) return "is led to the exit: a rest first; leaves only when well";
  const std::string next = paused_ ? "; PAUSE before the next step, p goes on" : "";
  if (!unit_) return paused_ ? "PAUSED; p goes on" : "waits for the first step";
  if (paused_ && unit_done_) return "PAUSED; p goes on";
  if (looks(now_ns)) return "looks at the stimulus" + next;
  std::string words = "on this page for " + short_time(on_page_s(now_ns));
  if (const auto idle = idle_ ? idle_() : std::nullopt)
    words += ", last key or mouse " + short_time(*idle) + " ago";
  return words + next;
}

std::string Console::describe_course() const {
  const Course& c = course_;
  if (unit_done_ || c.frames < 2) return "-";
  const double shown_s = 1e-9 * static_cast<double>(c.last_shown_ns - c.first_shown_ns);
  const double scheduled_s = 1e-9 * static_cast<double>(c.last_scheduled_ns - c.first_scheduled_ns);
  std::string line = fmt::format("{:.1f} s, rate {:+.2f} %, late {}, worst {:.2f} ms", shown_s,
                                 100 * (scheduled_s / shown_s - 1), c.late, c.worst_late_ms);
  if (revealed_) {
    const double frames = static_cast<double>(c.frames - 1);
    line += fmt::format(", {:.1f} of {:.1f} frames/s", frames / shown_s, frames / scheduled_s);
  }
  return line;
}

std::vector<std::string> Console::alarms(std::int64_t now_ns, double disk_mb) const {
  std::vector<std::string> all;
  if (ending_) all.push_back(words_of(*ending_));
  if (trouble_) all.push_back(trouble_->what + "; " + trouble_->mend + "; then p goes on");
  if (disk_mb >= 0 && disk_mb < little_disk_mb)
    all.push_back(
        fmt::format("disk: only {:.0f} MB are free, less than {:.0f} MB; free space before the next trial",
                    disk_mb, little_disk_mb));
  if (const char* failure = failure_of(verdicts_))
    all.push_back(fmt::format("trial {}: ", last_trial_->trial->position + 1) + failure +
                  "; r shows it again, else the timing rule excludes it");
  if (!unit_done_ && course_.late > 0)
    all.push_back(fmt::format("{} late frame{} in this showing; close other programs", course_.late,
                              course_.late == 1 ? "" : "s"));
  const auto idle = idle_ ? idle_() : std::nullopt;
  if (session_ && unit_ && !unit_done_ && !looks(now_ns) && idle &&
      std::min(*idle, on_page_s(now_ns)) > long_s)
    all.push_back("nothing was pressed for " + short_time(*idle) + "; see how the participant is");
  all.insert(all.end(), warnings_.rbegin(), warnings_.rend());
  return all;
}

void Console::trouble(const Trouble& trouble) {
  const std::lock_guard<std::mutex> guard(mutex_);
  trouble_ = trouble;
  paused_ = true;
  say("PAUSED: " + trouble.what + "; " + trouble.mend + "; then p goes on");
}

ConsoleView Console::view(std::int64_t now_ns) const {
  const double disk_mb = free_mb(database_);  // before locking: a slow disk must not delay frames
  const std::lock_guard<std::mutex> guard(mutex_);
  ConsoleView view;
  view.clock = clock_time();
  view.title = protocol_.name + " " + protocol_.version;
  view.person = describe_person(now_ns);
  view.alarms = alarms(now_ns, disk_mb);
  view.typed = asking_ != Asking::Nothing ? prompt_ + typed_ : "";
  view.rate = describe_course();
  view.strip = unit_done_ ? "" : course_.strip;
  if (verdicts_.empty()) view.last = "-";
  for (const TimingVerdict& verdict : verdicts_)
    view.last += (view.last.empty() ? "" : "; ") + describe(verdict);
  if (!session_) return view;
  view.title = session_->plan.participant + fmt::format(", visit {}: ", session_->plan.visit) + view.title +
               (session_->plan.test_data ? " (test data)" : "");
  const std::size_t left_units = session_->units.size() - std::min(done_, session_->units.size());
  const std::size_t before = session_->planned - std::min(left_units, session_->planned);
  view.done =
      session_->planned > 0 ? static_cast<double>(before) / static_cast<double>(session_->planned) : 1;
  view.plan = fmt::format("{} of {} steps done; left: ", before, session_->planned) + left();
  view.now = unit_ ? describe(*unit_) : "-";
  view.station = "gaze " + session_->plan.gaze_source + fmt::format("; disk {:.1f} GB free", 1e-3 * disk_mb) +
                 (session_->plan.station.empty() ? "" : "; " + session_->plan.station);
  return view;
}

}  // namespace study
