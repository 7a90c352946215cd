#include "apps/study/check_report.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <set>
#include <string>

#include "libsim/scene/scene.hpp"
#include "libstudy/analysis/claims.hpp"
#include "libstudy/protocol/method_claims.hpp"
#include "libstudy/stimulus/bakes/bake_plan.hpp"
#include "stats/base/file.hpp"
#include "stats/base/text.hpp"

namespace apps {

namespace {

using study::TimingSource;

/// The reason why a setting is not exact. Under timing = "table2", where each stimulus has its own setting,
/// also names the stimulus.
std::string remark_of(const CheckReport& report, std::size_t setting, const std::string& reason) {
  if (report.protocol.design.timing != TimingSource::Table2) return reason;
  const auto& cells = report.settings[setting].cells;
  std::string out =
      study::stimulus_name(report.protocol.design.cells[static_cast<std::size_t>(cells.front())].stimulus);
  if (cells.size() > 1) out += " and " + std::to_string(cells.size() - 1) + " more";
  return reason.empty() ? out : out + ": " + reason;
}

double longest_ms(const study::RefreshCheck& check, std::size_t setting) {
  return 1000 * check.verdicts[setting].longest_hold / check.refresh_hz;
}

/// Prints the tests and fits that vip-stats will report for this protocol. For a protocol with factors,
/// prints the questions that vip-stats will report by cell instead.
void print_analyses(const study::Protocol& protocol) {
  if (!protocol.design.factors.empty()) {
    const std::string ids = base::joined(questions_by_cell(protocol));
    std::printf("reported by cell: %s\n", ids.empty() ? "nothing, as the trials ask nothing" : ids.c_str());
    return;
  }
  const auto shown = study::hypotheses_of(protocol, {});
  std::string ids;
  for (const auto& one : shown.claims) ids += (ids.empty() ? "" : ", ") + one.id;
  if (!ids.empty()) std::printf("tested: %s\n", ids.c_str());
  for (const auto& question : study::curve_questions(protocol))
    std::printf("fitted: the curve of question %s, at level %g of %d to %d\n", question.id.c_str(),
                study::fitted_level(question), question.scale_min, question.scale_max);
  for (const auto& [id, reason, ids_left_out] : shown.left_out)
    std::printf("not tested: %s, as %s\n", id.c_str(), reason.c_str());
}

/// Prints a table with a row for each cell: its level of each factor, its stimulus and its timing.
void print_cells_of(const study::Design& design) {
  std::vector<std::vector<std::string>> rows(1);
  for (const study::DesignFactor& factor : design.factors)
    rows[0].push_back(factor.name + (factor.between ? " (between)" : ""));
  rows[0].insert(rows[0].end(), {"stimulus", "timing"});
  for (const study::Cell& cell : design.cells) {
    rows.emplace_back();
    for (std::size_t f = 0; f < design.factors.size(); ++f)
      rows.back().push_back(study::level_name(design, cell, f));
    rows.back().push_back(study::stimulus_name(cell.stimulus));
    rows.back().push_back(study::setting_name(cell.setting));
  }
  std::printf("\n%zu cells of %zu factor%s:\n", design.cells.size(), design.factors.size(),
              design.factors.size() == 1 ? "" : "s");
  std::vector<std::size_t> widths(rows[0].size());
  for (const auto& row : rows)
    for (std::size_t i = 0; i < row.size(); ++i) widths[i] = std::max(widths[i], row[i].size());
  for (const auto& row : rows) {
    std::string line;
    for (std::size_t i = 0; i + 1 < row.size(); ++i) line += fmt::format("  {:{}}", row[i], widths[i]);
    std::printf("%s  %s\n", line.c_str(), row.back().c_str());
  }
}

/// Prints what an adaptive procedure chooses, from which levels and by which answers.
void print_procedure(const study::Design& design) {
  const study::Procedure& procedure = *design.procedure;
  const study::DesignFactor& factor = design.factors[procedure.factor];
  std::string levels;
  for (const std::size_t i : candidate_levels(design)) {
    levels += (levels.empty() ? "" : ", ") + factor.levels[i] + fmt::format(" ({:g}", procedure.values[i]);
    if (i < procedure.deviation.size()) levels += fmt::format(", {:g}", procedure.deviation[i]);
    levels += ')';
  }
  const int tracks = tracks_of(design);
  std::printf(
      "procedure: %s chooses the level of %s by the answers to %s; %d track%s of %d trials in a "
      "session\n",
      study::procedure_word(procedure.kind), factor.name.c_str(), procedure.question.c_str(), tracks,
      tracks == 1 ? "" : "s", procedure.trials);
  std::printf("candidate levels (%s): %s\n",
              procedure.axis.empty() ? "mean, SD of frames/s" : procedure.axis.c_str(), levels.c_str());
  if (procedure.kind == study::ProcedureKind::Staircase) {
    const auto share = stats::target_share(procedure.rules);
    std::printf("staircase: starts at %s, down after %d, up after %d%s\n",
                factor.levels[static_cast<std::size_t>(procedure.rules.start)].c_str(),
                procedure.rules.down_after, procedure.rules.up_after,
                share ? fmt::format("; leads to {:.1f} % positive answers", 100 * *share).c_str() : "");
  }
}

/// Explains why the longer of the two expected durations is longer: slow reading and longer breaks. Empty if
/// neither applies.
std::string slower_words(const study::Protocol& protocol) {
  const auto any = [&](auto holds) {
    return std::any_of(protocol.blocks.begin(), protocol.blocks.end(), holds);
  };
  std::string out;
  if (any([](const study::Block& block) { return !block.text.empty(); }))
    out += fmt::format("texts read at {:g} words/s", study::slow_pace.words_per_s);
  if (any([](const study::Block& block) {
        return block.kind == study::BlockKind::Break || block.between_groups_s > 0 || block.break_every > 0;
      }))
    out += fmt::format("{}each break {:g} s longer than it must be", out.empty() ? "" : " and ",
                       study::slow_pace.break_s);
  return out.empty() ? "" : " (the longer with " + out + ")";
}

void print_session(const CheckReport& report) {
  const auto& protocol = report.protocol;
  std::printf("%s %s, language %s, sha256 %.12s\n\n%-14s %-13s %13s  %s\n", protocol.name.c_str(),
              protocol.version.c_str(), protocol.language.c_str(), protocol.sha256.c_str(), "block", "kind",
              "minutes", "what");
  for (const auto& outline : report.outline.blocks) {
    std::printf("%-14s %-13s %5.1f to %4.1f  %s\n", outline.block->id.c_str(),
                study::block_kind_name(outline.block->kind).c_str(), outline.seconds.least / 60,
                outline.seconds.most / 60, study::describe_block(protocol, outline).c_str());
  }
  const auto& all = report.outline;
  std::printf(
      "\nplan: %d units, %d trials; %.1f to %.1f min with %g to %g s an answer%s, %.1f to %.1f min of them "
      "the %d trials of the design\n",
      all.units, all.trials, all.session_s.least / 60, all.session_s.most / 60, study::quick_pace.answer_s,
      study::slow_pace.answer_s, slower_words(protocol).c_str(), all.trials_s.least / 60,
      all.trials_s.most / 60, protocol.design.groups * study::trials_of_group(protocol.design));
  std::printf("a showing is cut, and fails, when it goes on for %g s past its %g s\n", overrun_s(protocol),
              protocol.design.cells.front().setting.duration_s);
  std::printf("balance: %s\n", study::describe_balance(protocol, report.balance).c_str());
  if (protocol.design.procedure) print_procedure(protocol.design);
  print_analyses(protocol);
}

void print_settings(const CheckReport& report, const study::RefreshCheck& check) {
  if (check.asked_hz != check.refresh_hz)
    std::printf(
        "\n%g Hz counts as %g Hz, as in run: holds are whole periods of it, and each showing is %.2f %% %s\n",
        check.asked_hz, check.refresh_hz, 100 * std::abs(check.refresh_hz / check.asked_hz - 1),
        check.asked_hz < check.refresh_hz ? "slower" : "faster");
  int width = 16;
  for (const auto& one : report.settings)
    width = std::max(width, static_cast<int>(study::setting_name(one.setting).size()));
  std::printf("\non %g Hz, %s mean, timing = %s\n%-*s %6s  %-11s %9s %8s %11s  %s\n", check.refresh_hz,
              mean_name(report.protocol), timing_name(report.protocol.design), width, "setting", "frames",
              "status", "mean", "sd", "longest ms", "what misses, and why");
  for (std::size_t i = 0; i < report.settings.size(); ++i) {
    const auto& verdict = check.verdicts[i];
    std::printf("%-*s %6lld  %-11s", width, study::setting_name(report.settings[i].setting).c_str(),
                static_cast<long long>(verdict.frames), study::feasibility_name(verdict.feasibility).c_str());
    if (verdict.holds.empty())
      std::printf(" %9s %8s %11s", "-", "-", "-");
    else
      std::printf(" %9.4f %8.4f %11.1f", verdict.mean, verdict.sd, longest_ms(check, i));
    std::printf("  %s\n", remark_of(report, i, verdict.reason).c_str());
  }
  std::printf("\n%d exact, %d approximate, %d unreachable of %zu\n", check.exact, check.approximate,
              check.unreachable, report.settings.size());
  if (check.unreachable > 0) {
    std::printf("run refuses this protocol on %g Hz: %d settings are unreachable\n", check.refresh_hz,
                check.unreachable);
  } else if (check.approximate > 0 && !report.protocol.accept_approximate) {
    std::printf("run refuses approximate settings unless the protocol says accept_approximate = true\n");
  }
}

void print_common(const std::vector<study::RefreshCheck>& checks) {
  std::printf("\nexact settings by refresh:");
  for (const auto& check : checks) std::printf(" %g Hz %d;", check.refresh_hz, check.exact);
  const auto& best = study::best_refresh(checks);
  std::printf("\nbest of these: %g Hz, %d exact, mean distance to the unquantised rates %.2g frames/s\n",
              best.refresh_hz, best.exact, best.distance);
}

void print_speed(const CheckReport& report) {
  const auto& content = report.protocol.content;
  if (report.settings.empty()) {
    std::printf("play speed: %s\n", content.real_time ? "real time" : "rate of the machine x content_step_s");
    return;
  }
  const study::Span speeds = play_speeds(report);
  std::printf("play speed: %.2f to %.2f of real time (%s, content step %.4g ms): part of the stimulus\n",
              speeds.least, speeds.most, content.real_time ? "real_time" : "per_frame: mean x content_step_s",
              1000 * content.content_step_s);
}

/// True if the stimulus's scene has free obstacles, which a bake of particles does not store.
bool has_free_obstacles(const study::PlannedStimulus& one) {
  return sim::any_free(sim::read_scene(base::find_input(one.what.scene)).obstacles);
}

void print_stimuli(const CheckReport& report) {
  bool bakes = false;
  for (const auto& level : report.protocol.design.effects)
    std::printf("%seffects \"%s\": %s\n", &level == &report.protocol.design.effects.front() ? "\n" : "",
                level.name.c_str(), level.words.c_str());
  if (report.protocol.design.paint_temperature)
    std::printf("overlay: temperature is painted over the water of every stimulus\n");
  std::printf("\nstimuli:\n");
  const auto plan = study::plan_bakes(report.protocol);
  const auto name_of = [](const study::PlannedStimulus& one) {
    return study::stimulus_name(one.what) + (one.rate ? " at " + study::setting_name(*one.rate) : "");
  };
  std::size_t width = 28;
  for (const auto& one : plan) width = std::max(width, name_of(one).size());
  for (const auto& one : plan) {
    std::printf("  %-*s ", static_cast<int>(width), name_of(one).c_str());
    if (!one.live.empty()) {
      std::printf("live: %s\n", one.live.c_str());
    } else {
      std::printf("baked%s, %lld frames; or live where the machine is fast enough\n",
                  has_free_obstacles(one) ? " with --keep pictures, because its obstacles are free" : "",
                  static_cast<long long>(one.frames));
      bakes = true;
    }
  }
  if (bakes) {
    std::printf(
        "to bake: vip-study bake --protocol FILE --out FOLDER --size WIDTHxHEIGHT%s, with the angle options "
        "of run; to use: run --stimulus FOLDER\n",
        study::varies_surface(report.protocol.design) ? " --keep pictures" : "");
  }
  const bool native = report.protocol.design.timing == TimingSource::Native;
  const bool hypotheses = report.protocol.design.factors.empty();
  std::printf("gaze: %s%s\n", report.protocol.needs_gaze ? "needed" : "not needed",
              report.protocol.needs_gaze && hypotheses
                  ? ("; without tracked gaze " +
                     study::ids_with(study::shipped_claims(), &stats::MethodClaim::needs_gaze) +
                     " are labelled not testable")
                        .c_str()
                  : "");
  if (!report.measured) {
    std::printf("live methods: not measured; --measure says whether this machine shows them in time%s\n",
                native ? ", and whether they differ at all under timing = \"native\"" : "");
  }
}

void print_framing(const CheckReport& report) {
  std::printf("\nframing:\n");
  for (const study::FramedScene& one : report.scenes) {
    std::printf("  %s", study::describe_framing(one).c_str());
    for (const std::string& name : one.cut) std::printf("; %s leaves the picture", name.c_str());
    if (one.cut.empty())
      std::printf(one.scene.visible.empty() ? "; the scene declares nothing that must stay visible"
                                            : "; all that must stay visible is in the picture");
    std::printf("\n");
  }
  for (const std::string& note : study::framing_notes(report.protocol, report.scenes))
    std::printf("  %s\n", note.c_str());
}

}  // namespace

const char* mean_name(const study::Protocol& protocol) {
  return protocol.pacing.mean == study::FpsMean::Harmonic ? "harmonic" : "arithmetic";
}

const char* timing_name(const study::Design& design) {
  switch (design.timing) {
    case TimingSource::Native:
      return "native";
    case TimingSource::Equal:
      return "equal";
    case TimingSource::Table2:
      return "table2";
    case TimingSource::Profiles:
      return "profiles";
    default:
      return "settings";
  }
}

std::vector<std::string> questions_by_cell(const study::Protocol& protocol) {
  std::vector<std::string> out;
  for (const study::Block& block : protocol.blocks) {
    if (block.kind != study::BlockKind::Stimulus) continue;
    for (const study::TrialStep& step : block.steps) {
      for (const std::string& id : step.asks) {
        const bool counted =
            std::any_of(block.questions.begin(), block.questions.end(), [&](const study::Question& question) {
              return question.id == id && question.kind != study::AnswerKind::Text && !question.personal;
            });
        if (counted && std::find(out.begin(), out.end(), id) == out.end()) out.push_back(id);
      }
    }
  }
  return out;
}

std::vector<std::size_t> candidate_levels(const study::Design& design) {
  std::set<std::size_t> out;
  for (const study::Cell& cell : design.cells)
    if (!design.standard || !study::is_standard(design, cell))
      out.insert(static_cast<std::size_t>(cell.levels[design.procedure->factor]));
  return {out.begin(), out.end()};
}

int tracks_of(const study::Design& design) {
  return study::trials_of_group(design) / design.procedure->trials;
}

double overrun_s(const study::Protocol& protocol) {
  const double duration_s = protocol.design.cells.front().setting.duration_s;
  return static_cast<double>(study::showing_bounds(protocol.timing, duration_s).overrun_ns) / 1e9;
}

study::Span play_speeds(const CheckReport& report) {
  study::Span out{HUGE_VAL, 0};
  for (const auto& [setting, cells] : report.settings) {
    out.least = std::min(out.least, study::play_speed(report.protocol, setting));
    out.most = std::max(out.most, study::play_speed(report.protocol, setting));
  }
  return out;
}

void print_report(const CheckReport& report) {
  print_session(report);
  if (!report.protocol.design.factors.empty()) print_cells_of(report.protocol.design);
  if (report.refresh && !report.settings.empty()) print_settings(report, *report.refresh);
  if (!report.common.empty())
    print_common(report.common);
  else if (!report.settings.empty())
    std::printf("\nother refresh rates: --compare checks them, which takes minutes with so many frames\n");
  print_speed(report);
  print_stimuli(report);
  print_framing(report);
  if (report.measured) std::printf("\nmeasured here:\n%s", study::measured_table(*report.measured).c_str());
}

}  // namespace apps
