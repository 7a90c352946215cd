/// vip-study light: compares a light sensor's log with the record, and raises the grade of its evidence.

#include <fmt/format.h>
#include <unistd.h>
#include <CLI/CLI.hpp>

#include <algorithm>
#include <cstdio>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "apps/common/options.hpp"
#include "apps/study/clean_up.hpp"
#include "apps/study/commands.hpp"
#include "apps/study/session_player.hpp"
#include "libstudy/console/certificate.hpp"
#include "libstudy/light/light_edges.hpp"
#include "libstudy/light/sensor_log.hpp"
#include "libstudy/store/light_evidence.hpp"
#include "libstudy/store/names.hpp"
#include "libstudy/store/read/light_record.hpp"
#include "libstudy/store/read/status.hpp"
#include "libstudy/store/store.hpp"
#include "stats/base/error.hpp"
#include "stats/base/streams.hpp"
#include "stats/base/text.hpp"

namespace apps {

namespace {

struct LightOptions {
  std::string file, database, participant;
  int visit = 0;
  study::SensorChoice choice;
  double hold_ms = 0;
  bool inverted = false;
};

/// A stretch of a session, and what the log says about it.
struct JudgedStretch {
  study::LitStretch stretch;
  study::LightFit fit;
  std::vector<study::LightEvidence> evidence;  ///< of each showing, also of those without a judgement
};

/// The log's changes of light and its triggers.
struct SensedLight {
  study::SensorLog log;
  std::vector<study::LightEdge> edges, triggers;
};

SensedLight sense(const LightOptions& options) {
  SensedLight out;
  out.log = study::read_sensor_log(options.file, options.choice);
  if (options.inverted)
    for (float& level : out.log.level) level = -level;
  const auto levels = study::find_levels(out.log.level, options.file, "its level");
  out.edges = study::find_edges(out.log, out.log.level, levels, 1e-3 * options.hold_ms);
  const bool triggered = std::any_of(out.log.trigger.begin(), out.log.trigger.end(),
                                     [&](float value) { return value != out.log.trigger.front(); });
  if (triggered) {
    const auto lines = study::find_levels(out.log.trigger, options.file, "its trigger line", 0);
    out.triggers = study::find_edges(out.log, out.log.trigger, lines, 0);
  }
  const double seconds = out.log.time_s.back();
  std::printf("%s: %s\n%zu rows in %.1f s, %zu changes of light, dark %.4g, bright %.4g, noise %.2g\n",
              base::for_terminal(options.file).c_str(), base::for_terminal(out.log.format).c_str(),
              out.log.time_s.size(), seconds, out.edges.size(), (options.inverted ? -1 : 1) * levels.low,
              (options.inverted ? -1 : 1) * levels.high, levels.noise);
  for (const std::string& remark : out.log.remarks) std::printf("%s\n", remark.c_str());
  return out;
}

/// The stretches that have a patch and were shown to somebody. base::Error if there are none.
std::vector<study::LitStretch> lit_stretches(const LightOptions& options) {
  auto all = study::read_light_record(options.database, options.participant, options.visit);
  const std::string who = options.participant.empty()
                              ? std::string("no session of it")
                              : "no session of " + base::shortened(options.participant);
  const bool patched = std::any_of(all.begin(), all.end(), [](const auto& one) { return one.patch; });
  if (!patched)
    throw base::Error(options.database, who + " was run with --light-patch, so that no sensor saw its frames",
                      "run a session with vip-study run --light-patch, and record the sensor meanwhile");
  std::erase_if(all, [](const auto& one) { return !one.patch || one.virtual_clock || one.showings.empty(); });
  if (all.empty())
    throw base::Error(options.database, who + " with a light patch has a showing in real time",
                      "give the database of a session on the real clock (--clock real) with a whole showing");
  return all;
}

JudgedStretch judged(study::LitStretch stretch, study::LightFit fit, const SensedLight& sensed) {
  JudgedStretch out;
  for (const study::ShowingLight& light : fit.showings) {
    study::LightEvidence one;
    one.light = light;
    one.grade = study::light_grade(light, sensed.log.interval_s, one.why_not);
    one.log_sha256 = sensed.log.sha256;
    one.interval_ms = 1e3 * sensed.log.interval_s;
    one.drift_ppm = fit.drift_ppm;
    one.absolute = fit.absolute;
    out.evidence.push_back(std::move(one));
  }
  out.stretch = std::move(stretch);
  out.fit = std::move(fit);
  return out;
}

std::vector<JudgedStretch> judge(const LightOptions& options, const SensedLight& sensed) {
  std::vector<JudgedStretch> out;
  std::string reasons;
  for (study::LitStretch& stretch : lit_stretches(options)) {
    std::vector<study::RecordedShowing> shown;
    for (const study::LitShowing& one : stretch.showings) shown.push_back(one.shown);
    std::string why;
    auto fit = study::fit_light(sensed.log, sensed.edges, shown, sensed.triggers, stretch.markers_ns, why);
    if (fit && fit->judged == 0) why = "no whole showing lies in the log";
    if (fit && fit->judged > 0)
      out.push_back(judged(std::move(stretch), std::move(*fit), sensed));
    else
      reasons += (reasons.empty() ? "" : "; ") + base::shortened(stretch.participant) + ", visit " +
                 std::to_string(stretch.visit) + ": " + why;
  }
  if (out.empty())
    throw base::Error(options.file, "does not fit a session of " + options.database + " (" + reasons + ")",
                      "give the log of that session; a display that lights up in pulses needs --hold-ms, a "
                      "sensor whose level falls in light --inverted");
  return out;
}

/// The grade of a showing after the log: never worse than the recorded one.
std::string grade_after(const study::LightEvidence& light, const std::string& recorded) {
  const std::string grade = light.grade ? study::grade_name(*light.grade) : "";
  if (grade.empty() || recorded.empty()) return recorded;
  return std::min(grade, recorded);
}

std::string missed_text(const std::vector<std::int64_t>& missed) {
  constexpr std::size_t most = 8;
  std::string text;
  for (std::size_t i = 0; i < std::min(most, missed.size()); ++i)
    text += (i > 0 ? ", " : "") + std::to_string(missed[i]);
  return missed.size() > most ? text + ", ..." : text;
}

void print(const JudgedStretch& one) {
  const study::LightFit& fit = one.fit;
  std::printf(
      "\n%s, visit %d: %lld of %zu showings in the log; the sensor's clock runs %.1f ppm %s; dark "
      "onsets come %.2f ms %s\n",
      one.stretch.participant.c_str(), one.stretch.visit, static_cast<long long>(fit.judged),
      fit.showings.size(), std::abs(fit.drift_ppm), fit.drift_ppm < 0 ? "slow" : "fast",
      std::abs(fit.fall_shift_ms), fit.fall_shift_ms < 0 ? "earlier" : "later");
  if (fit.absolute)
    std::printf(
        "lag: from the record's onset to light, by %lld triggers; it holds as exactly as the markers' "
        "own latency is known\n",
        static_cast<long long>(fit.triggers));
  else
    std::printf(
        "lag: relative to the median showing; without triggers in the log the time from the record's "
        "onset to light is not known\n");
  std::printf(
      "trial attempt stimulus frames matched missed hidden extra   lag ms jitter ms worst ms grade\n");
  for (std::size_t i = 0; i < one.evidence.size(); ++i) {
    const study::LightEvidence& evidence = one.evidence[i];
    const study::ShowingLight& light = evidence.light;
    const study::LitShowing& shown = one.stretch.showings[i];
    std::string line =
        fmt::format("{:5} {:7} {:8} {:6}", shown.position, shown.attempt, shown.interval + 1, light.frames);
    if (light.unjudged.empty()) {
      line += fmt::format(" {:7} {:6} {:6} {:5} {:8.3f} {:9.3f} {:8.3f} {} -> {}", light.matched,
                          light.missed.size(), light.hidden, light.extra, light.lag_ms, light.jitter_ms,
                          light.worst_ms, shown.grade.empty() ? "-" : shown.grade,
                          grade_after(evidence, shown.grade));
    } else {
      line += fmt::format("  {:>56}", "stays " + shown.grade);
    }
    if (!evidence.why_not.empty()) line += ": " + evidence.why_not;
    if (!light.missed.empty()) line += " (frames " + missed_text(light.missed) + ")";
    std::printf("%s\n", line.c_str());
  }
}

void store_light(const LightOptions& options, const std::vector<JudgedStretch>& all) {
  study::Store store(options.database, study::sqlite::Open::Write, 0, tell_of_locks(options.database));
  print_list("Still left of a withdrawal or a merge:", store.left_to_clean());
  for (const JudgedStretch& one : all) {
    std::vector<study::LightEvidence> kept;
    for (const study::LightEvidence& evidence : one.evidence)
      if (evidence.light.unjudged.empty()) kept.push_back(evidence);
    store.add_light(one.stretch.session, kept);
  }
  store.require_journal();
}

/// Prints the certificate of each protocol that these sessions followed.
void print_certificates(const LightOptions& options, const std::vector<JudgedStretch>& all) {
  for (const study::ProtocolRow& row : study::read_status(options.database).protocols) {
    const bool read =
        std::any_of(all.begin(), all.end(), [&](const auto& one) { return one.stretch.protocol == row.id; });
    if (!read) continue;
    const auto protocol = study::parse_protocol(row.text, row.name, study::ProtocolUse::Stored);
    const study::FpsMean mean = protocol.pacing.mean;
    const auto rows = study::read_certificate_of_protocol(options.database, row.id, mean);
    base::print_coloured(study::format_certificate(rows, mean, ::isatty(STDOUT_FILENO) == 1));
  }
}

void read_light(const LightOptions& options) {
  const SensedLight sensed = sense(options);
  const auto all = judge(options, sensed);
  store_light(options, all);
  std::map<std::string, int> grades;
  for (const JudgedStretch& one : all) {
    print(one);
    for (std::size_t i = 0; i < one.evidence.size(); ++i)
      ++grades[grade_after(one.evidence[i], one.stretch.showings[i].grade)];
  }
  std::string counts;
  for (const auto& [grade, count] : grades)
    counts += fmt::format("{}{} of grade {}", counts.empty() ? "" : ", ", count, grade.empty() ? "-" : grade);
  std::printf("\nshowings now: %s; stored in %s\n", counts.c_str(), options.database.c_str());
  print_certificates(options, all);
}

}  // namespace

void add_light_command(CLI::App& app) {
  auto options = std::make_shared<LightOptions>();
  CLI::App& sub = *app.add_subcommand(
      "light",
      "Compare a light sensor's log with the record of a run with --light-patch, and raise its grade");
  sub.add_option(
         "file", options->file,
         "Log of the sensor: time, level and, if recorded, trigger; CSV, an Arduino's lines or events of "
         "a Black Box ToolKit")
      ->required();
  add_database(sub, options->database);
  sub.add_option("--participant", options->participant,
                 "Only sessions of this participant; without: those that the log fits");
  sub.add_option("--visit", options->visit, "Only this visit")->check(CLI::Range(1, 1000));
  sub.add_option("--unit", options->choice.unit, "Unit of the log's times, if its first line does not say it")
      ->check(CLI::IsMember({"s", "ms", "us"}));
  sub.add_option("--columns", options->choice.columns,
                 "Columns of time, level and, if any, trigger, by name or by number from 1")
      ->delimiter(',');
  sub.add_option(
         "--hold-ms", options->hold_ms,
         "Bridge dark gaps shorter than this, of displays that light up in pulses (most headsets): more "
         "than the pause between two pulses, less than a frame, ms")
      ->check(CLI::Range(0.0, 100.0));
  sub.add_flag("--inverted", options->inverted, "The sensor's level falls in light");
  sub.callback([options] { read_light(*options); });
}

}  // namespace apps
