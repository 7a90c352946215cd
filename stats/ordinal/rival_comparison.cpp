#include "stats/ordinal/rival_comparison.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <random>
#include <stdexcept>

namespace stats {

namespace {

/// The group of each person. Equal seeds give equal groups on every machine: std::mt19937_64 and the shuffle
/// below are exact.
std::vector<int> groups_of(int people, const RivalComparisonOptions& options) {
  const int folds = rival_group_count(people, options);
  std::vector<int> order(static_cast<std::size_t>(people)), out(order.size());
  std::iota(order.begin(), order.end(), 0);
  std::mt19937_64 engine(options.seed);
  for (std::size_t i = order.size(); options.folds > 0 && i > 1; --i)
    std::swap(order[i - 1], order[engine() % i]);
  for (std::size_t i = 0; i < order.size(); ++i)
    out[static_cast<std::size_t>(order[i])] = static_cast<int>(i) % folds;
  return out;
}

/// The fit without the people of one group.
Result<RivalFit> fit_without(const RivalFitter& fitter, const std::vector<int>& groups, int group) {
  std::vector<char> in;
  for (const int g : groups) in.push_back(g != group);
  return fitter.fit_some(in);
}

/// Scores of the people of one group by the fit without them.
void score_group(const RivalFitter& fitter, const RivalAnswers& answers, const std::vector<int>& groups,
                 int group, const RivalFit& fit, RivalScore& out) {
  for (std::size_t p = 0; p < groups.size(); ++p)
    if (groups[p] == group) out.by_person[p] = fitter.log_score(fit, static_cast<int>(p));
  for (std::size_t i = 0; i < answers.n(); ++i)
    if (groups[static_cast<std::size_t>(answers.person[i])] == group)
      out.probabilities[i] = fitter.probabilities(fit, i);
}

/// The values minus their mean, divided by their SD; empty if they do not vary.
std::vector<double> standard(std::span<const double> values) {
  double mean = 0, squares = 0;
  const double n = static_cast<double>(values.size());
  for (const double v : values) mean += v / n;
  for (const double v : values) squares += (v - mean) * (v - mean) / n;
  if (!(squares > 1e-20 * (1 + mean * mean))) return {};
  std::vector<double> out;
  for (const double v : values) out.push_back((v - mean) / std::sqrt(squares));
  return out;
}

/// R^2 of y on v and v^2; both are standardised.
double quadratic_share(std::span<const double> y, std::span<const double> v) {
  double cubes = 0, fourth = 0, yv = 0, yvv = 0;
  const double n = static_cast<double>(y.size());
  for (std::size_t i = 0; i < y.size(); ++i) {
    cubes += v[i] * v[i] * v[i] / n;
    fourth += std::pow(v[i], 4) / n;
    yv += y[i] * v[i] / n;
    yvv += y[i] * v[i] * v[i] / n;
  }
  // w = v^2 - 1 - cubes v is orthogonal to 1 and v.
  const double ww = fourth - 1 - cubes * cubes, yw = yvv - cubes * yv;
  return std::min(1.0, yv * yv + (ww > 1e-9 ? yw * yw / ww : 0));
}

void set_verdict(RivalComparison& out, int reference) {
  const auto score = [&](int model) -> const std::vector<double>& {
    return out.models[static_cast<std::size_t>(model)].by_person;
  };
  const auto rival = std::find_if(out.order.begin(), out.order.end(), [&](int m) { return m != reference; });
  const int best = *rival;
  for (const int m : out.order) {
    RivalScore& one = out.models[static_cast<std::size_t>(m)];
    const auto lead = rival_lead(score(best), one.by_person);
    one.behind = -lead.difference;
    one.behind_se = lead.se;
    if (m == best || (m != reference && !lead.leads())) out.in_the_running.push_back(m);
  }
  out.verdict = out.in_the_running.size() == 1 ? RivalVerdict::Winner : RivalVerdict::Undecided;
  const bool scored = std::find(out.order.begin(), out.order.end(), reference) != out.order.end();
  if (!scored) return;
  const auto misfit = rival_lead(score(reference), score(best));
  if (misfit.leads()) {
    out.verdict = RivalVerdict::NoneFits;
  } else if (misfit.difference > 0) {
    out.verdict = RivalVerdict::Undecided;
  }
}

}  // namespace

RivalLead rival_lead(std::span<const double> a, std::span<const double> b) {
  const double n = static_cast<double>(a.size());
  double sum = 0, squares = 0;
  for (std::size_t i = 0; i < a.size(); ++i) sum += a[i] - b[i];
  for (std::size_t i = 0; i < a.size(); ++i) squares += std::pow(a[i] - b[i] - sum / n, 2);
  return {sum, std::sqrt(n * squares / (n - 1))};
}

int rival_group_count(int people, const RivalComparisonOptions& options) {
  if (options.folds == 1 || options.folds < 0 || options.folds > people)
    throw std::invalid_argument("compare_rivals: " + std::to_string(options.folds) +
                                " folds; give 0, or 2 to the number of people");
  return options.folds == 0 ? people : options.folds;
}

std::vector<Result<RivalFit>> fit_without_groups(const RivalModel& model, const RivalAnswers& answers,
                                                 const RivalComparisonOptions& options, RivalGroups groups) {
  const auto of = groups_of(answers.people, options);
  RivalFitter fitter(model, answers, options.fit);
  const auto whole = fitter.fit();
  std::vector<Result<RivalFit>> out(static_cast<std::size_t>(groups.count), Refusal{whole.reason()});
  if (!whole) return out;
#pragma omp parallel for schedule(dynamic)
  for (int g = 0; g < groups.count; ++g)
    out[static_cast<std::size_t>(g)] = fit_without(fitter, of, groups.first + g);
  return out;
}

Result<RivalComparison> compare_rivals(const std::vector<RivalModel>& models, const RivalAnswers& answers,
                                       int reference, const RivalComparisonOptions& options,
                                       const std::vector<std::vector<Result<RivalFit>>>* without) {
  if (answers.people < least_people_to_compare)
    return Refusal{"models are compared over at least " + std::to_string(least_people_to_compare) +
                   " people, not " + std::to_string(answers.people)};
  const auto groups = groups_of(answers.people, options);
  const int folds = rival_group_count(answers.people, options);
  const auto complete = [&](const auto& fits) { return fits.size() == static_cast<std::size_t>(folds); };
  if (without && (without->size() != models.size() || !std::ranges::all_of(*without, complete)))
    throw std::invalid_argument("compare_rivals: give a fit for each model and group, or none");
  RivalComparison out;
  out.people = answers.people;
  out.answers = answers.n();
  std::vector<RivalFitter> fitters;
  for (const RivalModel& model : models) {
    fitters.emplace_back(model, answers, options.fit);
    RivalScore& one = out.models.emplace_back();
    one.name = model.name;
    one.by_person.assign(static_cast<std::size_t>(answers.people), 0);
    one.probabilities.resize(answers.n());
  }
  const int count = static_cast<int>(models.size());
#pragma omp parallel for schedule(dynamic)
  for (int m = 0; m < count; ++m)
    out.models[static_cast<std::size_t>(m)].fit = fitters[static_cast<std::size_t>(m)].fit();
  std::vector<std::string> reasons(static_cast<std::size_t>(count * folds));
#pragma omp parallel for schedule(dynamic)
  for (int task = 0; task < count * folds; ++task) {
    const auto m = static_cast<std::size_t>(task / folds), g = static_cast<std::size_t>(task % folds);
    if (!out.models[m].fit) continue;
    const auto fit = without ? (*without)[m][g] : fit_without(fitters[m], groups, task % folds);
    reasons[static_cast<std::size_t>(task)] = fit.reason();
    if (fit) score_group(fitters[m], answers, groups, task % folds, *fit, out.models[m]);
  }
  std::vector<std::vector<double>> scores;
  std::vector<int> rivals;
  for (int m = 0; m < count; ++m) {
    RivalScore& one = out.models[static_cast<std::size_t>(m)];
    for (int f = 0; f < folds && one.fit; ++f)
      if (const auto& reason = reasons[static_cast<std::size_t>(m * folds + f)]; !reason.empty())
        one.fit = Refusal{"without some people: " + reason};
    if (!one.fit) continue;
    one.total = std::accumulate(one.by_person.begin(), one.by_person.end(), 0.0);
    out.order.push_back(m);
    if (m == reference) continue;
    rivals.push_back(m);
    scores.push_back(one.by_person);
  }
  if (rivals.size() < 2) return Refusal{"fewer than two models can be fitted"};
  std::stable_sort(out.order.begin(), out.order.end(), [&](int a, int b) {
    return out.models[static_cast<std::size_t>(a)].total > out.models[static_cast<std::size_t>(b)].total;
  });
  const auto weights = stacking_weights(scores);
  for (std::size_t k = 0; k < rivals.size(); ++k)
    out.models[static_cast<std::size_t>(rivals[k])].weight = weights[k];
  set_verdict(out, reference);
  return out;
}

std::vector<double> stacking_weights(const std::vector<std::vector<double>>& scores) {
  if (scores.empty()) throw std::invalid_argument("stacking_weights: no models; give at least one");
  const std::size_t models = scores.size(), people = scores.front().size();
  std::vector<std::vector<double>> likely(models, std::vector<double>(people));
  for (std::size_t i = 0; i < people; ++i) {
    double largest = -HUGE_VAL;
    for (const auto& one : scores) largest = std::max(largest, one.at(i));
    for (std::size_t k = 0; k < models; ++k) {
      if (!std::isfinite(scores[k][i]))
        throw std::invalid_argument("stacking_weights: a score is not finite; leave its model out");
      likely[k][i] = std::exp(scores[k][i] - largest);
    }
  }
  // The iteration of the EM algorithm for a mixture with known parts. gain[k] <= 1 for all models is the
  // condition of the maximum (Karush-Kuhn-Tucker); the largest gain minus 1 bounds what is left to win for
  // each person.
  std::vector<double> w(models, 1 / static_cast<double>(models)), gain(models);
  for (int iteration = 0; iteration < 200000; ++iteration) {
    std::fill(gain.begin(), gain.end(), 0.0);
    for (std::size_t i = 0; i < people; ++i) {
      double mixture = 0;
      for (std::size_t k = 0; k < models; ++k) mixture += w[k] * likely[k][i];
      for (std::size_t k = 0; k < models; ++k)
        gain[k] += likely[k][i] / mixture / static_cast<double>(people);
    }
    if (*std::max_element(gain.begin(), gain.end()) < 1 + 1e-7) break;
    for (std::size_t k = 0; k < models; ++k) w[k] *= gain[k];
  }
  return w;
}

double imitated_share(std::span<const double> target, const std::vector<std::vector<double>>& x) {
  if (x.empty() || x.size() > 2 || x.front().size() != target.size() || x.back().size() != target.size())
    throw std::invalid_argument("imitated_share: give one or two columns of the target's length");
  const auto y = standard(target), x1 = standard(x.front()), x2 = standard(x.back());
  if (y.empty() || x1.empty()) return 0;
  if (x.size() == 1 || x2.empty()) return quadratic_share(y, x1);
  double best = 0;
  for (int step = -400; step <= 400; ++step) {
    const double c = std::tan(step / 400.0 * 1.5);  // dense about 0, up to 14 SDs
    std::vector<double> v;
    for (std::size_t i = 0; i < x1.size(); ++i) v.push_back(x1[i] - c * x2[i]);
    if (const auto z = standard(v); !z.empty()) best = std::max(best, quadratic_share(y, z));
  }
  return best;
}

}  // namespace stats
