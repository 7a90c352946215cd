
#include "apps/study/check_report.hpp"
#include "libstudy/analysis/claims.hpp"
#include "libstudy/stimulus/bakes/bake_plan.hpp"
#include "stats/base/json.hpp"

namespace apps {

namespace {

base::Json setting_json(const study::CheckedSetting& checked, const study::RefreshVerdict& verdict,
                        double refresh_hz) {
  base::Json json{{"mean_fps", checked.setting.mean},
                  {"sd_fps", checked.setting.sd},
                  {"duration_s", checked.setting.duration_s},
                  {"cells", checked.cells},
                  {"frames", verdict.frames},
                  {"status", study::feasibility_name(verdict.feasibility)},
                  {"reason", verdict.reason}};
  if (checked.setting.profile) json["timing"] = study::setting_name(checked.setting);
  if (verdict.holds.empty()) return json;
  json["best_mean_fps"] = verdict.mean;
  json["best_sd_fps"] = verdict.sd;
  json["longest_hold_periods"] = verdict.longest_hold;
  json["longest_hold_ms"] = 1000 * verdict.longest_hold / refresh_hz;
  json["distance_fps"] = verdict.distance;
  return json;
}

base::Json surface_json(const study::StimulusSpec& what) {
  return what.surface.empty() ? base::Json() : base::Json(what.surface);
}

base::Json effects_json(const study::StimulusSpec& what) {
  return what.effects.empty() ? base::Json() : base::Json(what.effects);
}

void add_refresh(base::Json& json, const CheckReport& report) {
  if (!report.refresh) return;
  const study::RefreshCheck& check = *report.refresh;
  json["refresh_hz"] = check.refresh_hz;
  json["asked_refresh_hz"] = check.asked_hz;
  json["exact"] = check.exact;
  json["approximate"] = check.approximate;
  json["unreachable"] = check.unreachable;
  for (std::size_t i = 0; i < report.settings.size(); ++i)
    json["settings"].push_back(setting_json(report.settings[i], check.verdicts[i], check.refresh_hz));
}

void add_common(base::Json& json, const CheckReport& report) {
  if (!report.settings.empty()) {
    const study::Span speeds = play_speeds(report);
    json["play_speed"] = {speeds.least, speeds.most};
  }
  if (report.common.empty()) return;
  json["best_refresh_hz"] = study::best_refresh(report.common).refresh_hz;
  for (const auto& rate : report.common) {
    json["common_refreshes"].push_back({{"refresh_hz", rate.refresh_hz},
                                        {"exact", rate.exact},
                                        {"approximate", rate.approximate},
                                        {"unreachable", rate.unreachable},
                                        {"distance_fps", rate.distance}});
  }
}

void add_framing(base::Json& json, const CheckReport& report) {
  for (const study::FramedScene& one : report.scenes) {
    const auto& drawn = one.view.viewport;
    base::Json framing{{"scene", one.file},
                       {"width_px", drawn.width},
                       {"height_px", drawn.height},
                       {"camera_angle_deg", one.framing.camera_deg},
                       {"visual_angle_deg", nullptr},
                       {"angle_ratio", nullptr},
                       {"cut", one.cut}};
    if (one.framing.visual_deg) {
      framing["visual_angle_deg"] = *one.framing.visual_deg;
      framing["angle_ratio"] = *one.framing.ratio();
    }
    json["framing"].push_back(framing);
  }
}

void add_measured(base::Json& json, const study::MeasuredReport& measured) {
  json["too_slow"] = measured.too_slow;
  json["collapse"] = measured.collapse;
  for (const auto& one : measured.cells) {
    json["measured"].push_back({{"scene", one.what.scene},
                                {"method", one.what.method},
                                {"effects", effects_json(one.what)},
                                {"surface", surface_json(one.what)},
                                {"n_star", one.what.n_star},
                                {"asked_mean_fps", one.setting.mean},
                                {"asked_sd_fps", one.setting.sd},
                                {"fps_mean", one.fps.mean},
                                {"fps_sd", one.fps.sd},
                                {"p95_ms", one.p95_ms},
                                {"tau_min", one.tau_min},
                                {"showing_s", one.showing_s},
                                {"too_slow", one.too_slow},
                                {"words", one.words}});
  }
}

/// The tests and fits that vip-stats will report, and the tests that it will not report. For a protocol with
/// factors: the questions that it will report by cell.
base::Json analyses_json(const study::Protocol& protocol) {
  auto tested = base::Json::array(), fitted = tested, not_tested = tested;
  if (!protocol.design.factors.empty())
    return {{"tested", tested},
            {"fitted", fitted},
            {"not_tested", not_tested},
            {"by_cell", questions_by_cell(protocol)}};
  const auto shown = study::hypotheses_of(protocol, {});
  for (const auto& one : shown.claims) tested.push_back(one.id);
  for (const auto& question : study::curve_questions(protocol))
    fitted.push_back({{"question", question.id}, {"level", study::fitted_level(question)}});
  for (const auto& [id, reason, ids] : shown.left_out) not_tested.push_back({{"id", id}, {"reason", reason}});
  return {{"tested", tested}, {"fitted", fitted}, {"not_tested", not_tested}};
}

void add_factors(base::Json& json, const study::Design& design) {
  for (const study::DesignFactor& factor : design.factors)
    json["factors"].push_back(
        {{"name", factor.name}, {"vary", factor.between ? "between" : "within"}, {"levels", factor.levels}});
  for (const study::Cell& cell : design.cells) {
    base::Json levels = base::Json::object();
    for (std::size_t f = 0; f < design.factors.size(); ++f)
      levels[design.factors[f].name] = study::level_name(design, cell, f);
    json["cells"].push_back({{"levels", levels},
                             {"scene", cell.stimulus.scene},
                             {"method", cell.stimulus.method},
                             {"effects", effects_json(cell.stimulus)},
                             {"surface", surface_json(cell.stimulus)},
                             {"n_star", cell.stimulus.n_star},
                             {"timing", study::setting_name(cell.setting)},
                             {"mean_fps", cell.setting.mean},
                             {"sd_fps", cell.setting.sd}});
  }
  if (!design.procedure) return;
  const study::Procedure& procedure = *design.procedure;
  auto levels = base::Json::array(), values = levels, deviation = levels;
  for (const std::size_t i : candidate_levels(design)) {
    levels.push_back(design.factors[procedure.factor].levels[i]);
    values.push_back(procedure.values[i]);
    if (!procedure.deviation.empty()) deviation.push_back(procedure.deviation[i]);
  }
  json["procedure"] = {{"kind", study::procedure_word(procedure.kind)},
                       {"factor", design.factors[procedure.factor].name},
                       {"question", procedure.question},
                       {"tracks", tracks_of(design)},
                       {"trials", procedure.trials},
                       {"axis", procedure.axis.empty() ? base::Json() : base::Json(procedure.axis)},
                       {"levels", levels},
                       {"values", values},
                       {"sd_fps", deviation}};
}

}  // namespace

base::Json report_json(const CheckReport& report) {
  const auto& protocol = report.protocol;
  base::Json json{{"protocol", protocol.name},
                  {"protocol_version", protocol.version},
                  {"protocol_sha256", protocol.sha256},
                  {"mean", mean_name(protocol)},
                  {"timing", timing_name(protocol.design)},
                  {"needs_gaze", protocol.needs_gaze},
                  {"overlay", protocol.design.paint_temperature ? "temperature" : "none"},
                  {"units", report.outline.units},
                  {"trials", report.outline.trials},
                  {"overrun_s", overrun_s(protocol)},
                  {"plan_s", report.outline.shown_s},
                  {"plan_with_answers_s", {report.outline.trials_s.least, report.outline.trials_s.most}},
                  {"session_s", {report.outline.session_s.least, report.outline.session_s.most}}};
  for (const auto& one : report.outline.blocks) {
    json["blocks"].push_back({{"id", one.block->id},
                              {"kind", study::block_kind_name(one.block->kind)},
                              {"pages", one.pages},
                              {"trials", one.trials},
                              {"seconds", {one.seconds.least, one.seconds.most}}});
  }
  if (!protocol.design.factors.empty()) add_factors(json, protocol.design);
  json["analyses"] = analyses_json(protocol);
  const study::PlannedBalance& balance = report.balance;
  json["balance"] = {{"participants", balance.planned},
                     {"sequences", balance.sequences},
                     {"least", balance.least},
                     {"most", balance.most},
                     {"interval_difference", balance.interval_difference},
                     {"even", balance.even},
                     {"even_below", balance.even_below},
                     {"even_above", balance.even_above}};
  add_refresh(json, report);
  add_common(json, report);
  for (const auto& one : study::plan_bakes(protocol)) {
    json["stimuli"].push_back({{"scene", one.what.scene},
                               {"method", one.what.method},
                               {"effects", effects_json(one.what)},
                               {"surface", surface_json(one.what)},
                               {"n_star", one.what.n_star},
                               {"live", !one.live.empty()},
                               {"why_live", one.live},
                               {"bake_file", one.file},
                               {"bake_frames", one.frames}});
  }
  add_framing(json, report);
  if (report.measured) add_measured(json, *report.measured);
  return json;
}

}  // namespace apps
