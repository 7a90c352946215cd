#include "libstudy/analysis/ptpe/people_contours.hpp"

#include <algorithm>
#include <cmath>

#include "stats/base/file.hpp"

namespace study {

namespace {

constexpr const char* contour_model =
    "P(Y <= j) = (1 - lapse) Phi(theta_j - L) + lapse (j + 1) / choices, L = v (k + m delta + q v) + drift "
    "t, "
    "v = log mu - log a_p - b_p delta, (log a_p, b_p) normal over people; a person's expected answer without "
    "lapses equals the level at v = 0";

Json curve_json(const stats::CurveMoments& curve) {
  return {{"a", json_number(curve.curve.a())},
          {"b", json_number(curve.curve.b)},
          {"log_a_se", json_number(std::sqrt(curve.var_log_a))},
          {"b_se", json_number(std::sqrt(curve.var_b))}};
}

Json spread_estimate_json(const stats::SpreadEstimate& one) {
  return {{"value", json_number(one.value)}, {"ci", json_interval(one.ci)}};
}

Json person_json(const PeopleContours& contours, const stats::PersonContour& one) {
  Json json = curve_json(one.pooled);
  json["participant"] = contours.code(one);
  json["answers"] = one.answers;
  json["settings"] = one.settings;
  json["a_ci"] = json_interval(one.a_ci);
  json["b_ci"] = json_interval(one.b_ci);
  json["own_share"] = json_number(one.own_share);
  json["alone"] = json_result(one.alone, curve_json);
  json["doubt"] = contours.doubt(one);
  json["curve"] = Json::array();
  for (const double delta : contours.fit.deltas)
    json["curve"].push_back(
        {{"delta", delta},
         {"mu", json_number(one.pooled.curve.mu(delta))},
         {"ci", json_interval(one.band(delta, contours.confidence))},
         {"in_reach", std::find(one.in_reach.begin(), one.in_reach.end(), delta) != one.in_reach.end()}});
  return json;
}

}  // namespace

const std::string& PeopleContours::code(const stats::PersonContour& one) const {
  return data.participants.at(static_cast<std::size_t>(one.participant));
}

std::string PeopleContours::doubt(const stats::PersonContour& one) const {
  if (std::find(reversed.begin(), reversed.end(), one.participant) != reversed.end())
    return "the person rated higher frame rates lower";
  return one.doubt();
}

const stats::PersonContour* PeopleContours::find(const std::string& wanted) const {
  for (const auto& one : fit.people)
    if (code(one) == wanted) return &one;
  return nullptr;
}

stats::Result<PeopleContours> fit_people_contours(TaskData data, double level, double confidence,
                                                  const stats::PilotRules& rules) {
  const auto raters = stats::pilot_people(data.ratings, confidence);
  stats::PilotRules kept;
  kept.exclude_reverse_coders = rules.exclude_reverse_coders;
  data.ratings = stats::apply_rules(data.ratings, raters, kept);
  stats::PeopleOptions options;
  options.choices = static_cast<int>(scores_of(data.question).size());
  options.confidence = confidence;
  const auto fit = stats::fit_people(data.ratings, stats::PilotMean::Harmonic, level, options);
  if (!fit) return stats::Refusal{fit.reason()};
  PeopleContours out{std::move(data), *fit, {}, confidence};
  for (const auto& slope : raters.slopes)
    if (slope.reversed) out.reversed.push_back(slope.participant);
  return out;
}

Json people_contours_json(const PeopleContours& contours) {
  const auto& fit = contours.fit;
  const auto& data = contours.data;
  int excluded = 0;
  for (const auto& one : data.exclusions) excluded += one.answers;
  Json json{{"schema", "vip-people-contours/1"},
            {"version", base::version()},
            {"date_utc", base::utc_now()},
            {"protocol", {{"name", data.protocol.name}, {"sha256", data.protocol.sha256}}},
            {"question", data.question.id},
            {"level", fit.level},
            {"fps_mean", "harmonic"},
            {"rates", data.rates_words()},
            {"confidence", contours.confidence},
            {"model", contour_model},
            {"people", fit.people.size()},
            {"answers", fit.n},
            {"settings", fit.settings},
            {"answers_excluded", excluded},
            {"test_data", data.test_data},
            {"simulated_participants", data.simulated.size()}};
  if (!data.imported.empty()) json["imported"] = data.imported;
  const auto& population = fit.population;
  json["population"] = {{"a", json_number(population.curve.a())},
                        {"a_ci", json_interval(population.a_ci)},
                        {"b", json_number(population.curve.b)},
                        {"b_ci", json_interval(population.b_ci)},
                        {"in_reach", fit.in_reach}};
  json["between_people"] = {{"sd_log_a", spread_estimate_json(fit.sd_log_a)},
                            {"sd_b", spread_estimate_json(fit.sd_b)},
                            {"correlation", spread_estimate_json(fit.correlation)}};
  json["drift"] =
      fit.drift ? spread_estimate_json(*fit.drift) : json_refused("a trial's position is not known");
  json["lapse"] = fit.lapse;
  json["k"] = fit.k;
  json["m"] = fit.m;
  json["q"] = fit.q;
  json["scores"] = fit.levels;
  json["thresholds"] = fit.thresholds;
  json["log_likelihood"] = fit.log_likelihood;
  json["participants"] = Json::array();
  for (const auto& one : fit.people) json["participants"].push_back(person_json(contours, one));
  return json;
}

sim::PtpeFile person_ptpe_file(const PeopleContours& contours, const stats::PersonContour& one) {
  const auto& data = contours.data;
  sim::PtpeFile file;
  file.model = {one.pooled.curve.a(), one.pooled.curve.b};
  file.level = contours.fit.level;
  file.a_ci = one.a_ci;
  file.b_ci = one.b_ci;
  file.n_participants = 1;
  file.n_simulated =
      static_cast<int>(std::count(data.simulated.begin(), data.simulated.end(), contours.code(one)));
  file.test_data = data.test_data;
  file.participant = contours.code(one);
  file.protocol_sha256 = data.protocol.sha256;
  file.date_utc = base::utc_now();
  for (const double delta : contours.fit.deltas)
    file.band.push_back({delta, one.band(delta, contours.confidence),
                         std::find(one.in_reach.begin(), one.in_reach.end(), delta) != one.in_reach.end()});
  return file;
}

}  // namespace study
