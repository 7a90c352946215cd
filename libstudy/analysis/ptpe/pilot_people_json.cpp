#include "libstudy/analysis/ptpe/pilot_people_json.hpp"

#include <fmt/format.h>
#include <algorithm>
#include <cmath>
#include <string>

#include "libstudy/analysis/json_parts.hpp"
#include "stats/base/json.hpp"

namespace study {

namespace {

using Json = base::Json;

std::string p_words(double p) {
  return fmt::format("p {} {:.3f}", p < 0.001 ? "<" : "=", std::max(p, 0.001));
}

std::string reversed_text(const PilotFit& fit) {
  const auto& slopes = fit.people.slopes;
  const auto limit = stats::reverse_level / std::max<double>(1, static_cast<double>(slopes.size()));
  const std::string rule = fmt::format("slope within each person, one-sided p below {:.2g}", limit);
  if (fit.people.reversed() == 0) return "no participant rated higher frame rates lower (" + rule + ")";
  return fmt::format("{} of {} participants rated higher frame rates lower ({})", fit.people.reversed(),
                     slopes.size(), rule);
}

std::string drift_text(const stats::SessionDrift& drift) {
  const int digits = interval_decimals(drift.ci, 2);
  return fmt::format(
      "scores change by {:+.2f} [{:.{}f}, {:.{}f}] points from the first to the last trial, "
      "t({}) = {:.2f}, {}",
      drift.change, drift.ci[0], digits, drift.ci[1], digits, drift.df, drift.t, p_words(drift.p));
}

std::string lapse_text(const stats::LapseCount& lapses) {
  return fmt::format(
      "{} of {} answers for which it is improbable are at the lowest score, {:.1f} expected, {} "
      "(lapses in {:.1f} %)",
      lapses.lapsed, lapses.at_risk, lapses.expected, p_words(lapses.p), 100 * lapses.rate);
}

std::string far_text(const stats::FarAnswers& far) {
  return fmt::format("{} of {} answers are far from the score expected, {:.1f} expected, {}", far.far,
                     far.answers, far.expected, p_words(far.p));
}

}  // namespace

Json raters_json(const PilotFit& fit) {
  Json drift{{"rule", fit.rules.model_drift ? "model" : "keep"}};
  if (fit.people.drift) {
    const auto& test = *fit.people.drift;
    drift.update({{"change", test.change},
                  {"ci", test.ci},
                  {"t", test.t},
                  {"df", test.df},
                  {"p", test.p},
                  {"found", test.found()},
                  {"text", drift_text(test)}});
  } else {
    drift["refused"] = fit.people.drift.reason();
  }
  Json lapses{{"rule", fit.rules.model_lapses ? "model" : "keep"}};
  if (fit.people.lapses) {
    const auto& count = *fit.people.lapses;
    lapses.update({{"at_risk", count.at_risk},
                   {"lapsed", count.lapsed},
                   {"expected", count.expected},
                   {"p", count.p},
                   {"rate", count.rate},
                   {"found", count.found()},
                   {"text", lapse_text(count)}});
  } else {
    lapses["refused"] = fit.people.lapses.reason();
  }
  Json far = Json::object();
  if (fit.people.far) {
    const auto& count = *fit.people.far;
    far = {{"answers", count.answers}, {"far", count.far},       {"expected", count.expected}, {"p", count.p},
           {"found", count.found()},   {"text", far_text(count)}};
  } else {
    far["refused"] = fit.people.far.reason();
  }
  return {{"reverse_coders",
           {{"rule", fit.rules.exclude_reverse_coders ? "exclude" : "keep"},
            {"found", fit.people.reversed()},
            {"tested", fit.people.slopes.size()},
            {"text", reversed_text(fit)}}},
          {"drift", drift},
          {"lapses", lapses},
          {"far_answers", far}};
}

std::vector<std::string> reverse_coders(const PilotFit& fit) {
  std::vector<std::string> out;
  for (const auto& one : fit.people.slopes)
    if (one.reversed)
      out.push_back(fmt::format("{} ({:+.2f} points for each doubling, one-sided {})",
                                fit.data.participants.at(static_cast<std::size_t>(one.participant)),
                                one.slope, p_words(one.p)));
  return out;
}

std::vector<FitFlag> rater_flags(const PilotFit& fit) {
  std::vector<FitFlag> out;
  if (fit.people.reversed() > 0)
    out.push_back(
        {"reverse_coders", reversed_text(fit) + (fit.rules.exclude_reverse_coders
                                                     ? "; left out, as the plan says"
                                                     : "; kept, as the plan does not exclude them")});
  if (fit.people.drift && fit.people.drift->found())
    out.push_back(
        {"drift", drift_text(*fit.people.drift) +
                      (fit.rules.model_drift ? "; taken off the scores, as the plan says"
                                             : "; kept in the scores, as the plan does not model it")});
  if (fit.people.lapses && fit.people.lapses->found())
    out.push_back(
        {"lapses", lapse_text(*fit.people.lapses) +
                       (fit.rules.model_lapses ? "; the scores are corrected by that rate, as the plan says"
                                               : "; kept in the scores, as the plan does not model them")});
  if (fit.people.far && fit.people.far->found())
    out.push_back({"far_answers", far_text(*fit.people.far) +
                                      "; people may have answered at random in a part of the trials"});
  return out;
}

}  // namespace study
