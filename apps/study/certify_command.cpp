/// vip-study certify: prints a timing certificate for frame logs that other programs recorded.

#include <fmt/format.h>
#include <CLI/CLI.hpp>

#include <cmath>
#include <cstdio>
#include <filesystem>
#include <memory>
#include <numeric>
#include <optional>
#include <string>
#include <vector>

#include "apps/common/options.hpp"
#include "apps/study/commands.hpp"
#include "libstudy/console/certificate.hpp"
#include "libstudy/pacing/frame_log.hpp"
#include "libstudy/pacing/pacer.hpp"
#include "libstudy/store/read/status.hpp"
#include "stats/base/text.hpp"

namespace apps {

namespace {

struct CertifyOptions {
  std::vector<std::string> files;
  std::string column;
  std::optional<double> mean, sd;
  bool arithmetic = false;
};

study::TimingVerdict verdict_of(const study::FrameLog& log, const std::optional<study::FpsSetting>& nominal,
                                study::FpsMean mean) {
  const study::TimingGrade grade = study::grade_of_log(log);
  study::PacingRules rules;
  rules.mean = mean;
  const study::PlayedTrial played = study::played_of_log(log);
  return nominal ? study::judge_trial(*nominal, rules, played, {}, grade)
                 : study::describe_trial(played, grade);
}

/// The line of the certificate for a log. Without a nominal setting it has no verdict.
study::CertificateRow row_of(const study::FrameLog& log, const std::string& name,
                             const study::TimingVerdict& verdict,
                             const std::optional<study::FpsSetting>& nominal, study::FpsMean mean) {
  study::CertificateRow row;
  row.nominal = nominal.value_or(study::FpsSetting{0, 0, 0});
  row.trials = 1;
  row.frames = static_cast<std::int64_t>(log.frame_ms.size());
  row.mean = verdict.realised.mean_of(mean);
  row.sd = verdict.realised.sd;
  row.mean_worst = std::abs(row.mean - row.nominal.mean);
  row.sd_worst = std::abs(row.sd - row.nominal.sd);
  if (nominal) {
    row.pass = verdict.verdict == study::Verdict::Pass;
    row.degraded = verdict.verdict == study::Verdict::Degraded;
    row.fail = verdict.verdict == study::Verdict::Fail;
  }
  row.grades = log.kind == study::Intervals::Named ? "-" : std::string(1, static_cast<char>(verdict.grade));
  row.levels = {{"log", name},
                {"program", log.source.empty() ? "-" : log.source},
                {"column", log.column.empty() ? "-" : base::shortened(log.column)}};
  row.timing = nominal ? fmt::format("{:g}, SD {:g}", nominal->mean, nominal->sd) : "-";
  row.p99_ms = verdict.p99_ms;
  row.longest_ms = verdict.longest_ms;
  row.hitches = static_cast<double>(verdict.hitches);
  row.animation_error_ms = log.animation_error_ms;
  return row;
}

const char* meaning_of(study::Intervals kind) {
  switch (kind) {
    case study::Intervals::Frames:
      return "intervals between frames of the program, which say nothing of when the display showed them";
    case study::Intervals::DisplayChanges:
      return "intervals between changes of the picture, as the display system reported them";
    case study::Intervals::Named:
      break;
  }
  return "taken for frame times, as --column asks";
}

/// One line about a log, with what the table has no column for: number of frames, duration, 95th percentile,
/// meaning of the intervals, rows without one, remarks.
std::string note_of(const study::FrameLog& log, const study::CertificateRow& row,
                    const study::TimingVerdict& verdict) {
  const double time_ms = std::accumulate(log.frame_ms.begin(), log.frame_ms.end(), 0.0);
  std::string note =
      fmt::format("{}, {}, {}: {} frames in {:.6f} s, 95 % of the intervals up to {:.3f} ms; {}",
                  row.levels[0].second, row.levels[1].second, row.levels[2].second, row.frames,
                  1e-3 * time_ms, verdict.p95_ms, meaning_of(log.kind));
  if (log.left_out > 0)
    note += fmt::format("; rows without an interval: {} ({})", log.left_out,
                        log.kind == study::Intervals::DisplayChanges
                            ? "frames that were never shown, or the first of the log"
                            : "the first of the log");
  if (log.animation_error_ms) note += fmt::format("; animation error of {} rows", log.animation_rows);
  for (const std::string& remark : log.remarks) note += "; " + remark;
  if (!verdict.reason.empty()) note += "; " + verdict.reason;
  return note + '\n';
}

void certify(const CertifyOptions& options) {
  std::optional<study::FpsSetting> nominal;
  if (options.mean) nominal = study::FpsSetting{*options.mean, options.sd.value_or(0)};
  const auto mean = options.arithmetic ? study::FpsMean::Arithmetic : study::FpsMean::Harmonic;
  std::vector<study::CertificateRow> rows;
  std::string notes;
  for (const std::string& file : options.files) {
    const std::string name =
        base::shortened(options.files.size() > 1 ? file : std::filesystem::path(file).filename().string());
    for (const study::FrameLog& log : study::read_frame_logs(file, options.column)) {
      const study::TimingVerdict verdict = verdict_of(log, nominal, mean);
      rows.push_back(row_of(log, name, verdict, nominal, mean));
      notes += note_of(log, rows.back(), verdict);
    }
  }
  std::string text = study::certificate_table(rows, mean, false);
  if (nominal) {
    std::size_t passed = 0;
    for (const study::CertificateRow& row : rows) passed += row.pass > 0;
    text += fmt::format("{} of {} lines pass\n", passed, rows.size());
  }
  text += "A log has no schedule, so no frame of it counts as late.\n";
  std::fputs((text + notes).c_str(), stdout);
}

}  // namespace

void add_certify_command(CLI::App& app) {
  auto options = std::make_shared<CertifyOptions>();
  CLI::App& sub = *app.add_subcommand(
      "certify", "Print the timing certificate of frame logs of other programs, such as PresentMon");
  sub.add_option("files", options->files, "CSV files or JSON files, in a format of docs/session.md")
      ->required();
  sub.add_option(
      "--column", options->column,
      "Column of frame times in ms (default: intervals between frames, and between changes of the picture)");
  auto* asked = sub.add_option("--mean", options->mean, "Mean frame rate that was asked for, frames/s")
                    ->check(number_in(0.1, 10000));
  sub.add_option("--sd", options->sd,
                 "Standard deviation of the frame rate that was asked for, frames/s (default 0)")
      ->check(number_in(0, 10000))
      ->needs(asked);
  sub.add_flag("--arithmetic", options->arithmetic,
               "Use the arithmetic mean of the rates, not the harmonic one");
  sub.callback([options] { certify(*options); });
}

}  // namespace apps
