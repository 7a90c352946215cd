#include "stats/inference/linear_mixed.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <numbers>
#include <set>
#include <stdexcept>

#include "stats/inference/distributions.hpp"
#include "stats/inference/restricted_likelihood.hpp"
#include "stats/minimise.hpp"

namespace stats {

namespace {

using Vector = std::vector<double>;
using Lambda = std::array<double, 2>;

/// A column counts as a combination of the earlier ones if at most this share of its squared length is
/// orthogonal to them.
constexpr double least_new = 1e-10;
/// Largest accepted lambda, the ratio of a random effect's standard deviation to the residual's. Beyond it a
/// participant's answers agree so closely that no residual is left.
constexpr double largest_ratio = 1e3;
/// A simpler model is preferred if its criterion (-2 times the restricted log-likelihood) is higher by less
/// than this.
constexpr double same_criterion = 1e-7;

/// Which random effects the model has: [0] of the participant, [1] of the participant with each thing judged.
using Effects = std::array<bool, 2>;

std::string refusal_of(std::span<const double> y, std::span<const int> participant) {
  if (!std::all_of(y.begin(), y.end(), [](double value) { return std::isfinite(value); }))
    return "an answer that is not finite";
  std::map<int, int> answers;
  for (const int person : participant) ++answers[person];
  if (answers.size() < 2) return "fewer than two participants";
  if (std::all_of(answers.begin(), answers.end(), [](const auto& one) { return one.second < 2; }))
    return "no participant gave two answers: their spread cannot be separated from that of the answers";
  return "";
}

/// True if any participant answered more than once about the same thing.
bool any_replicate(std::span<const int> participant, std::span<const int> thing) {
  std::set<std::pair<int, int>> seen;
  for (std::size_t i = 0; i < participant.size(); ++i) {
    if (!seen.insert({participant[i], thing[i]}).second) return true;
  }
  return false;
}

/// Adds each term's name to fit.terms, or to fit.left_out if its column is a linear combination of earlier
/// ones. Returns the columns of fit.terms.
std::vector<Vector> independent_columns(std::span<const Predictor> terms, LinearMixedFit& fit) {
  std::vector<Vector> kept, residuals;  // residuals: columns orthogonal to the columns before them
  for (const Predictor& term : terms) {
    Vector rest = term.values;
    const auto square = [](const Vector& v) {
      double sum = 0;
      for (const double x : v) sum += x * x;
      return sum;
    };
    const double whole = square(rest);
    for (int twice = 0; twice < 2; ++twice) {  // Gram-Schmidt, repeated against rounding
      for (const Vector& other : residuals) {
        double dot = 0;
        for (std::size_t i = 0; i < rest.size(); ++i) dot += rest[i] * other[i];
        dot /= square(other);
        for (std::size_t i = 0; i < rest.size(); ++i) rest[i] -= dot * other[i];
      }
    }
    const bool adds = square(rest) > least_new * whole;
    (adds ? fit.terms : fit.left_out).push_back(term.name);
    if (!adds) continue;
    kept.push_back(term.values);
    residuals.push_back(std::move(rest));
  }
  return kept;
}

/// The lambdas of both random effects, their standard deviations divided by the residual's: taken from x for
/// effects in the model, zero for the others.
Lambda spread(std::span<const double> x, Effects effects) {
  Lambda out{};
  std::size_t next = 0;
  for (std::size_t k = 0; k < 2; ++k) {
    if (effects[k]) out[k] = x[next++];
  }
  return out;
}

/// The criterion (-2 times the restricted log-likelihood) as a function of the model's lambdas, the standard
/// deviations of its random effects divided by the residual's, sigma. Sigma is the one that minimises the
/// criterion.
Objective profiled(const RestrictedLikelihood& likelihood, Effects effects) {
  return [&likelihood, effects](std::span<const double> x, std::span<double> gradient) {
    const auto at = likelihood.at(spread(x, effects));
    if (!at) return std::numeric_limits<double>::infinity();
    const double freedom = likelihood.freedom(), variance = at->residual / freedom;
    std::size_t next = 0;
    for (std::size_t k = 0; k < 2; ++k) {
      if (effects[k]) gradient[next++] = at->slope[k] + at->residual_slope[k] / variance;
    }
    return freedom * (std::log(2 * std::numbers::pi * variance) + 1) + at->log_determinants;
  };
}

struct Best {
  Effects effects{};
  Lambda lambda{};
  double value = std::numeric_limits<double>::infinity();
};

/// Finds the minimum of the criterion (-2 times the restricted log-likelihood) and the simplest model that
/// reaches it. That model omits an effect whose standard deviation is estimated as zero.
Best minimise_criterion(const RestrictedLikelihood& likelihood, bool replicated) {
  Best best;
  for (const Effects effects : {Effects{false, false}, {true, false}, {false, true}, {true, true}}) {
    if (effects[1] && !replicated) continue;
    const auto objective = profiled(likelihood, effects);
    Vector x(static_cast<std::size_t>(effects[0] + effects[1]), 0.7), gradient(x.size());
    double value = objective(x, gradient);
    if (!std::isfinite(value)) continue;
    if (!x.empty()) {
      const auto found = minimise(objective, x);
      x = found.x;
      value = found.value;
    }
    if (value < best.value - same_criterion) best = {effects, spread(x, effects), value};
  }
  return best;
}

/// Covariance of the estimates of the model's lambdas (standard deviations of its random effects divided by
/// the residual's) and of sigma (the residual's): the inverse of half the Hessian of the criterion, which is
/// -2 times the restricted log-likelihood.
std::optional<Vector> parameter_covariance(const RestrictedLikelihood& likelihood, const Best& best,
                                           const RestrictedLikelihood::At& at, double sigma) {
  std::vector<std::size_t> in;
  for (std::size_t k = 0; k < 2; ++k) {
    if (best.effects[k]) in.push_back(k);
  }
  const std::size_t m = in.size() + 1;
  Vector hessian(m * m);
  const double variance = sigma * sigma;
  for (std::size_t j = 0; j < in.size(); ++j) {
    const double step = 1e-4 * std::max(0.1, std::abs(best.lambda[in[j]]));
    Lambda above = best.lambda, below = best.lambda;
    above[in[j]] += step;
    below[in[j]] -= step;
    const auto up = likelihood.at(above), down = likelihood.at(below);
    if (!up || !down) return std::nullopt;
    for (std::size_t i = 0; i < in.size(); ++i) {
      const auto k = in[i];
      hessian[i * m + j] =
          ((up->slope[k] - down->slope[k]) + (up->residual_slope[k] - down->residual_slope[k]) / variance) /
          (2 * step);
    }
    hessian[j * m + m - 1] = hessian[(m - 1) * m + j] = -2 * at.residual_slope[in[j]] / (variance * sigma);
  }
  hessian[m * m - 1] = 4 * likelihood.freedom() / variance;
  const auto factor = Cholesky::of(hessian);
  if (!factor) return std::nullopt;
  Vector out = factor->inverse();
  for (double& v : out) v *= 2;
  return out;
}

std::string words_of_singular(Effects effects, bool replicated) {
  const bool no_thing = replicated && !effects[1];
  if (!effects[0] && no_thing) return "participants do not differ, neither in level nor by method";
  if (!effects[0]) return "participants do not differ in level";
  return no_thing ? "participants do not differ by method" : "";
}

double form(const Vector& matrix, std::span<const double> w) {
  double sum = 0;
  for (std::size_t i = 0; i < w.size(); ++i) {
    for (std::size_t j = 0; j < w.size(); ++j) sum += w[i] * matrix[i * w.size() + j] * w[j];
  }
  return sum;
}

/// Fills the fit from `best`, the minimum of the criterion (-2 times the restricted log-likelihood). Returns
/// false if the criterion's Hessian is not positive definite there.
bool fill_fit(const RestrictedLikelihood& likelihood, const Best& best, bool replicated,
              LinearMixedFit& fit) {
  const auto at = *likelihood.at(best.lambda);
  const double variance = at.residual / likelihood.freedom(), sigma = std::sqrt(variance);
  fit.beta = at.beta;
  fit.criterion = best.value;
  fit.sd_residual = sigma;
  fit.sd_participant = std::abs(best.lambda[0]) * sigma;
  if (replicated) fit.sd_thing = std::abs(best.lambda[1]) * sigma;
  fit.singular = words_of_singular(best.effects, replicated);
  const auto scaled = [](Vector matrix, double factor) {
    for (double& v : matrix) v *= factor;
    return matrix;
  };
  fit.covariance = scaled(at.inverse, variance);
  for (std::size_t k = 0; k < 2; ++k) {
    if (best.effects[k]) fit.covariance_slopes.push_back(scaled(at.inverse_slope[k], variance));
  }
  fit.covariance_slopes.push_back(scaled(fit.covariance, 2 / sigma));
  const auto spread_of_parameters = parameter_covariance(likelihood, best, at, sigma);
  if (spread_of_parameters) fit.parameter_covariance = *spread_of_parameters;
  return spread_of_parameters.has_value();
}

}  // namespace

int LinearMixedFit::index_of(const std::string& term) const {
  const auto found = std::find(terms.begin(), terms.end(), term);
  return found == terms.end() ? -1 : static_cast<int>(found - terms.begin());
}

MixedContrast LinearMixedFit::contrast(std::span<const double> weights, double confidence) const {
  if (weights.size() != beta.size())
    throw std::invalid_argument(
        "LinearMixedFit::contrast: not one weight for each term; give as many as `terms` has names");
  MixedContrast out;
  for (std::size_t i = 0; i < beta.size(); ++i) out.estimate += weights[i] * beta[i];
  const double variance = form(covariance, weights);
  if (!(variance > 0))
    throw std::invalid_argument("LinearMixedFit::contrast: all weights are 0; give at least one other");
  out.se = std::sqrt(variance);
  Vector slopes;
  for (const Vector& matrix : covariance_slopes) slopes.push_back(form(matrix, weights));
  out.df = 2 * variance * variance / form(parameter_covariance, slopes);
  out.t = out.estimate / out.se;
  out.p = student_p(out.t, out.df, Alternative::TwoSided);
  const double half = student_upper_quantile(0.5 - 0.5 * confidence, out.df) * out.se;
  out.ci = {out.estimate - half, out.estimate + half};
  return out;
}

Result<LinearMixedFit> fit_linear_mixed(std::span<const double> y, std::span<const Predictor> terms,
                                        std::span<const int> participant, std::span<const int> thing) {
  if (participant.size() != y.size() || thing.size() != y.size() ||
      std::any_of(terms.begin(), terms.end(), [&](const auto& one) { return one.values.size() != y.size(); }))
    throw std::invalid_argument(
        "fit_linear_mixed: the columns differ in length; give every column one value for each answer");
  if (const auto reason = refusal_of(y, participant); !reason.empty()) return Refusal{reason};
  LinearMixedFit fit;
  const auto columns = independent_columns(terms, fit);
  if (columns.size() >= y.size()) return Refusal{"no more answers than terms of the model"};
  const RestrictedLikelihood likelihood(columns, y, participant, thing);
  fit.n = static_cast<int>(y.size());
  fit.participants = likelihood.participants();
  const bool replicated = any_replicate(participant, thing);
  const Best best = minimise_criterion(likelihood, replicated);
  if (!std::isfinite(best.value)) return Refusal{"the answers leave no scatter beside the model's terms"};
  if (std::max(std::abs(best.lambda[0]), std::abs(best.lambda[1])) > largest_ratio)
    return Refusal{"each participant's answers agree with themselves and leave no residual"};
  if (!fill_fit(likelihood, best, replicated, fit)) return Refusal{"the mixed model did not converge"};
  return fit;
}

}  // namespace stats
