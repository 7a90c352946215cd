#include "stats/ptpe/people_fit.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <set>
#include <stdexcept>
#include <utility>

#include "stats/cholesky.hpp"
#include "stats/minimise.hpp"
#include "stats/ptpe/direct_fit.hpp"
#include "stats/ptpe/ordinal_pilot.hpp"
#include "stats/ptpe/people_pooling.hpp"
#include "stats/quantiles.hpp"

namespace stats {

namespace {

/// A pair (alpha, beta) of the centred rows, or a covariance of such pairs, in units of a and b.
CurveMoments in_units(const PeopleRows& rows, const PersonMoments& m) {
  const double h = rows.delta_mean / delta_unit;
  CurveMoments out;
  out.curve.b = m.mean[1] / delta_unit;
  out.curve.log_a = m.mean[0] + rows.x_mean - out.curve.b * rows.delta_mean;
  out.var_log_a = m.var_alpha - 2 * h * m.cov + h * h * m.var_beta;
  out.cov = (m.cov - h * m.var_beta) / delta_unit;
  out.var_b = m.var_beta / (delta_unit * delta_unit);
  return out;
}

double rate_of(const PilotRating& r, PilotMean mean) {
  return mean == PilotMean::Harmonic ? r.realised_mu : r.realised_mu_arithmetic;
}

/// The ratings as rows, the people by ascending participant.
PeopleRows people_rows(std::span<const PilotRating> ratings, PilotMean mean, const PeopleOptions& options) {
  PeopleRows rows;
  rows.choices = options.choices;
  std::set<double> scores;
  std::map<int, int> people;
  const double n = static_cast<double>(ratings.size());
  bool placed = options.drift;
  int first = std::numeric_limits<int>::max(), last = 0;
  for (const auto& r : ratings) {
    scores.insert(r.score);
    people[r.participant] = 0;
    rows.x_mean += std::log(rate_of(r, mean)) / n;
    rows.delta_mean += r.realised_delta / n;
    placed = placed && r.position >= 0;
    first = std::min(first, r.position);
    last = std::max(last, r.position);
  }
  placed = placed && last > first;
  for (auto& [participant, index] : people) index = rows.people++;
  rows.levels.assign(scores.begin(), scores.end());
  for (const auto& r : ratings) {
    rows.x.push_back(std::log(rate_of(r, mean)) - rows.x_mean);
    rows.d.push_back((r.realised_delta - rows.delta_mean) / delta_unit);
    rows.position.push_back(placed ? static_cast<double>(r.position - first) / (last - first) - 0.5 : 0);
    rows.category.push_back(static_cast<int>(
        std::lower_bound(rows.levels.begin(), rows.levels.end(), r.score) - rows.levels.begin()));
    rows.person.push_back(people.at(r.participant));
  }
  return rows;
}

std::set<std::pair<double, double>> settings_of(std::span<const PilotRating> ratings, int participant) {
  std::set<std::pair<double, double>> out;
  for (const auto& r : ratings)
    if (participant < 0 || r.participant == participant) out.insert({r.delta, r.mu});
  return out;
}

std::string why_no_pooling(std::span<const PilotRating> ratings, double level) {
  if (ratings.empty()) return "no ratings";
  std::set<int> people;
  std::set<double> deltas, scores;
  for (const auto& r : ratings) {
    if (settings_of(ratings, r.participant).size() >= 3) people.insert(r.participant);
    deltas.insert(r.delta);
    scores.insert(r.score);
  }
  if (static_cast<int>(people.size()) < least_people_to_pool)
    return "people are pooled from " + std::to_string(least_people_to_pool) + " on, and " +
           std::to_string(people.size()) + (people.size() == 1 ? " person has" : " people have") +
           " answers to three settings: repeated trials of one person are no further people";
  const auto settings = settings_of(ratings, -1).size();
  if (settings < least_settings_to_pool || deltas.size() < 2)
    return "a and b of each person need " + std::to_string(least_settings_to_pool) +
           " settings with two standard deviations of the frame rate, and there are " +
           std::to_string(settings) + " with " + std::to_string(deltas.size());
  if (scores.size() < 2) return "all ratings are equal: there is no threshold to estimate";
  if (!(level > *scores.begin() && level < *scores.rbegin()))
    return "the level does not lie between the lowest and the highest rating given";
  return "";
}

/// All parameters at the estimate without a spread of b, as PeoplePooling takes them.
std::vector<double> pooling_start(const OrdinalPilotFit& start, const PeopleRows& rows,
                                  const PeopleOptions& options) {
  std::vector<double> out;
  for (std::size_t j = 0; j + 1 < start.thresholds.size(); ++j)
    out.push_back(std::log(start.thresholds[j + 1] - start.thresholds[j]));
  out.resize(out.size() + PeopleAt::Count);
  const auto p = std::span(out).subspan(rows.gaps());
  p[PeopleAt::Alpha] = start.curve.log_a + start.curve.b * rows.delta_mean - rows.x_mean;
  p[PeopleAt::Beta] = start.curve.b * delta_unit;
  p[PeopleAt::K] = start.k + start.m * rows.delta_mean;
  if (!options.straight) {
    p[PeopleAt::M] = start.m * delta_unit;
    p[PeopleAt::Q] = start.q;
  }
  const double sd = std::clamp(start.sd_participant, 0.1, 3.0);
  p[PeopleAt::LogSdA] = std::log(sd / std::max(p[PeopleAt::K], 0.5));
  p[PeopleAt::LogSdB] = std::log(0.05);
  if (!options.lapse) p[PeopleAt::LapseRoot] = 0.2;
  return out;
}

/// The curve that one person's answers alone make most likely.
Result<CurveMoments> curve_alone(const PeoplePooling& pooling, const PeopleRows& rows, int person,
                                 const std::array<double, 2>& start) {
  constexpr double farthest = 2.5;  // log mu
  const Objective objective = [&](std::span<const double> own, std::span<double> slope) {
    std::array<double, 2> by{};
    if (std::hypot(own[0], own[1]) > farthest) return std::numeric_limits<double>::infinity();
    const double value = pooling.likelihood().of_person(person, pooling.at(), {own[0], own[1]}, by);
    slope[0] = -by[0];
    slope[1] = -by[1];
    return -value;
  };
  std::array<double, 2> ignored{};
  if (!std::isfinite(objective(start, ignored))) return Refusal{"an answer is impossible along the curve"};
  const auto found = minimise(objective, {start[0], start[1]});
  if (!found.converged) return Refusal{"the answers alone have no most likely curve"};
  const auto v = Cholesky::of(found.hessian)->inverse();
  return in_units(rows, {{found.x[0], found.x[1]}, v[0], v[1], v[3]});
}

SpreadEstimate spread_of(double value, double se, double z, double (*to)(double), double (*back)(double)) {
  const double at = to(value);
  return {value, {back(at - z * se), back(at + z * se)}};
}

void set_spread(PeopleFit& fit, PeoplePooling& pooling, const PeopleRows& rows, double z) {
  const auto spread = [&](const PeoplePooling& p) { return in_units(rows, p.spread()); };
  const auto now = spread(pooling);
  const auto log_ = [](double v) { return std::log(v); };
  const auto exp_ = [](double v) { return std::exp(v); };
  const auto atanh_ = [](double v) { return std::atanh(v); };
  const auto tanh_ = [](double v) { return std::tanh(v); };
  const auto correlation = [](const CurveMoments& m) { return m.cov / std::sqrt(m.var_log_a * m.var_b); };
  fit.sd_log_a =
      spread_of(std::sqrt(now.var_log_a),
                pooling.se([&](const auto& p) { return std::log(spread(p).var_log_a) / 2; }), z, log_, exp_);
  fit.sd_b =
      spread_of(std::sqrt(now.var_b),
                pooling.se([&](const auto& p) { return std::log(spread(p).var_b) / 2; }), z, log_, exp_);
  fit.correlation = spread_of(correlation(now),
                              pooling.se([&](const auto& p) { return std::atanh(correlation(spread(p))); }),
                              z, atanh_, tanh_);
}

/// Half width of the interval of a population value that has the variance `variance`. The part of it that is
/// the variance over people, `spread` / people, is known with people - 1 degrees of freedom, the rest much
/// better (Satterthwaite 1946, Biometrics Bull. 2, 110-114).
double half_width(double variance, double spread, int people, double confidence) {
  const double share = std::min(1.0, spread / people / variance);
  const double df = std::min(1e6, (people - 1) / (share * share));
  return student_quantile((1 + confidence) / 2, df) * std::sqrt(variance);
}

/// The nominal deltas at which the curve lies among the frame rates shown, with reach_margin.
std::vector<double> reached(std::span<const PilotRating> ratings, PilotMean mean, const Curve& curve) {
  std::map<double, std::array<double, 2>> shown;
  for (const auto& r : ratings) {
    const double mu = rate_of(r, mean);
    auto& range = shown.emplace(r.delta, std::array{mu, mu}).first->second;
    range = {std::min(range[0], mu), std::max(range[1], mu)};
  }
  std::vector<double> out;
  for (const auto& [delta, range] : shown) {
    const double mu = curve.mu(delta);
    if (mu >= range[0] / reach_margin && mu <= range[1] * reach_margin) out.push_back(delta);
  }
  return out;
}

double variance_sum(const PeopleRows& rows, const PersonMoments& m) {
  double out = 0;
  for (const double d : rows.d) out += m.var_alpha + 2 * d * m.cov + d * d * m.var_beta;
  return out;
}

std::vector<PersonContour> contours_of(std::span<const PilotRating> ratings, PilotMean mean,
                                       PeoplePooling& pooling, const PeopleRows& rows, double z,
                                       std::size_t deltas) {
  const auto given = pooling.moments();
  const auto whole = pooling.whole_moments();
  std::vector<PersonContour> out(given.size());
  std::vector<std::set<int>> categories(given.size());
  for (std::size_t i = 0; i < rows.n(); ++i) {
    const auto p = static_cast<std::size_t>(rows.person[i]);
    out[p].participant = ratings[i].participant;
    ++out[p].answers;
    categories[p].insert(rows.category[i]);
  }
  const double over_people = variance_sum(rows, pooling.spread());
  for (std::size_t p = 0; p < out.size(); ++p) {
    PersonContour& one = out[p];
    one.settings = static_cast<int>(settings_of(ratings, one.participant).size());
    one.same_answer = categories[p].size() == 1;
    one.pooled = in_units(rows, whole[p]);
    const Curve& curve = one.pooled.curve;
    const double a_half = z * std::sqrt(one.pooled.var_log_a), b_half = z * std::sqrt(one.pooled.var_b);
    one.a_ci = {std::exp(curve.log_a - a_half), std::exp(curve.log_a + a_half)};
    one.b_ci = {curve.b - b_half, curve.b + b_half};
    one.alone = curve_alone(pooling, rows, static_cast<int>(p), given[p].mean);
    one.own_share = 1 - variance_sum(rows, given[p]) / over_people;
    one.in_reach = reached(ratings, mean, curve);
    one.out_of_reach = 2 * one.in_reach.size() < deltas;
    one.log_mu_sd = std::sqrt(variance_sum(rows, whole[p]) / static_cast<double>(rows.d.size()));
  }
  return out;
}

}  // namespace

double CurveMoments::log_mu_sd(double delta) const {
  return std::sqrt(var_log_a + 2 * delta * cov + delta * delta * var_b);
}

std::string PersonContour::doubt() const {
  if (same_answer) return "all answers are equal";
  if (!alone) return alone.reason();
  if (out_of_reach) return "the curve lies outside the frame rates shown at more than half of the deltas";
  if (log_mu_sd > largest_log_mu_sd) return "the interval of the curve spans more than a factor of two";
  if (own_share < least_own_share) return "the answers say too little: the curve is mostly the population's";
  return "";
}

std::array<double, 2> PersonContour::band(double delta, double confidence) const {
  const double half = normal_quantile((1 + confidence) / 2) * pooled.log_mu_sd(delta);
  const double log_mu = pooled.curve.log_a + pooled.curve.b * delta;
  return {std::exp(log_mu - half), std::exp(log_mu + half)};
}

Result<PeopleFit> fit_people(std::span<const PilotRating> ratings, PilotMean mean, double level,
                             const PeopleOptions& options) {
  if (options.points < 3 || options.choices < 2 || !(options.confidence > 0 && options.confidence < 1) ||
      (options.lapse && !(*options.lapse >= 0 && *options.lapse < largest_lapse)))
    throw std::invalid_argument(
        "fit_people: give 3 or more points, 2 or more choices, a confidence within 0 to 1, and a lapse rate "
        "from 0 to below 0.5");
  if (const auto reason = why_no_pooling(ratings, level); !reason.empty()) return Refusal{reason};
  const auto start = fit_ordinal_pilot(ratings, mean, level);
  if (!start) return Refusal{start.reason()};
  const auto rows = people_rows(ratings, mean, options);
  PeoplePooling pooling(rows, level, options);
  if (!pooling.fit(pooling_start(*start, rows, options)))
    return Refusal{"the fit over people did not converge"};
  const double z = normal_quantile((1 + options.confidence) / 2), h = delta_unit;
  const double k = pooling.parameter(PeopleAt::K), m = pooling.parameter(PeopleAt::M);
  for (const double d : rows.d)
    if (!(k + m * d > 0)) return Refusal{"the scores do not rise with the frame rate all along the curve"};
  PeopleFit fit;
  fit.level = level;
  const auto middle = in_units(rows, {{pooling.parameter(PeopleAt::Alpha), pooling.parameter(PeopleAt::Beta)},
                                      pooling.covariance(PeopleAt::Alpha, PeopleAt::Alpha),
                                      pooling.covariance(PeopleAt::Alpha, PeopleAt::Beta),
                                      pooling.covariance(PeopleAt::Beta, PeopleAt::Beta)});
  fit.population = {middle.curve, middle.var_log_a, middle.cov,
                    middle.var_b, rows.people,      options.confidence};
  const auto over = in_units(rows, pooling.spread());
  const double a_half = half_width(middle.var_log_a, over.var_log_a, rows.people, options.confidence),
               b_half = half_width(middle.var_b, over.var_b, rows.people, options.confidence);
  fit.population.a_ci = {std::exp(middle.curve.log_a - a_half), std::exp(middle.curve.log_a + a_half)};
  fit.population.b_ci = {middle.curve.b - b_half, middle.curve.b + b_half};
  set_spread(fit, pooling, rows, z);
  fit.m = m / h;
  fit.k = k - fit.m * rows.delta_mean;
  fit.q = pooling.parameter(PeopleAt::Q);
  if (pooling.varies(PeopleAt::Drift)) {
    const double drift = pooling.parameter(PeopleAt::Drift),
                 half = z * std::sqrt(pooling.covariance(PeopleAt::Drift, PeopleAt::Drift));
    fit.drift = SpreadEstimate{drift, {drift - half, drift + half}};
  }
  double ignored = 0;
  fit.lapse =
      options.lapse.value_or(lapse_rate(pooling.parameter(PeopleAt::LapseRoot), least_people_lapse, ignored));
  fit.levels = rows.levels;
  fit.thresholds = pooling.thresholds().theta;
  fit.log_likelihood = pooling.log_likelihood();
  fit.n = static_cast<int>(rows.n());
  const auto settings = settings_of(ratings, -1);
  fit.settings = static_cast<int>(settings.size());
  for (const auto& [delta, mu] : settings)
    if (fit.deltas.empty() || fit.deltas.back() != delta) fit.deltas.push_back(delta);
  fit.in_reach = reached(ratings, mean, fit.population.curve);
  fit.people = contours_of(ratings, mean, pooling, rows, z, fit.deltas.size());
  return fit;
}

}  // namespace stats
