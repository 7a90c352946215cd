#include "stats/ptpe/people_pooling.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "stats/cholesky.hpp"
#include "stats/minimise.hpp"

namespace stats {

PeoplePooling::PeoplePooling(const PeopleRows& rows, double level, const PeopleOptions& options)
    : rows_(rows),
      options_(options),
      level_(level),
      likelihood_(rows, level, options.lapse.value_or(least_people_lapse), options.points) {
  for (std::size_t i = 0; i < likelihood_.size(); ++i)
    if (i < rows.gaps() || varies(i - rows.gaps())) free_.push_back(i);
}

bool PeoplePooling::varies(std::size_t i) const {
  switch (i) {
    case PeopleAt::M:
    case PeopleAt::Q:
      return !options_.straight;
    case PeopleAt::Drift:
      return std::any_of(rows_.position.begin(), rows_.position.end(), [](double t) { return t != 0; });
    case PeopleAt::LapseRoot:
      return !options_.lapse;
    default:
      return true;
  }
}

/// Minus the log-likelihood and the log priors.
double PeoplePooling::deviance(std::span<const double> x, std::span<double> slope) {
  for (std::size_t j = 0; j < x.size(); ++j) at_[free_[j]] = x[j];
  std::vector<double> gradient(at_.size());
  log_likelihood_ = likelihood_.evaluate(at_, gradient);
  if (!std::isfinite(log_likelihood_)) return std::numeric_limits<double>::infinity();
  double value = -log_likelihood_;
  const auto p = std::span(gradient).subspan(rows_.gaps());
  if (options_.hold_spread) {
    const double r = parameter(PeopleAt::ArtanhR);
    value -= parameter(PeopleAt::LogSdA) + parameter(PeopleAt::LogSdB) - std::log(std::cosh(r));
    p[PeopleAt::LogSdA] += 1;
    p[PeopleAt::LogSdB] += 1;
    p[PeopleAt::ArtanhR] -= std::tanh(r);
  }
  const double root = options_.lapse ? 0 : parameter(PeopleAt::LapseRoot);
  value += root * root / 2;
  p[PeopleAt::LapseRoot] -= root;
  for (std::size_t j = 0; j < x.size(); ++j) slope[j] = -gradient[free_[j]];
  return value;
}

std::vector<double> PeoplePooling::free_values() const {
  std::vector<double> out;
  for (const std::size_t i : free_) out.push_back(at_[i]);
  return out;
}

bool PeoplePooling::fit(std::vector<double> start) {
  at_ = std::move(start);
  std::vector<double> x = free_values(), slope(x.size()), small(x.size() * x.size());
  const Objective objective = [this](std::span<const double> point, std::span<double> by) {
    return deviance(point, by);
  };
  for (std::size_t i = 0; i < x.size(); ++i) small[i * x.size() + i] = 0.01;
  likelihood_.follow(true);
  if (!std::isfinite(objective(x, slope))) return false;
  x = minimise_near(objective, x, small).x;
  // The nodes stay during a round, so that the gradient is exact, and are placed anew before the next.
  for (int round = 0; round < 12; ++round) {
    likelihood_.follow(true);
    if (!std::isfinite(objective(x, slope))) return false;
    likelihood_.follow(false);
    const auto found = round == 0 ? minimise(objective, x) : minimise_near(objective, x, covariance_);
    if (!found.converged) return false;
    if (round == 0) covariance_ = Cholesky::of(found.hessian)->inverse();
    double change = 0;
    for (std::size_t i = 0; i < x.size(); ++i) change = std::max(change, std::abs(found.x[i] - x[i]));
    x = found.x;
    if (round == 0 || change >= 1e-4) continue;
    deviance(x, slope);
    return true;
  }
  return false;
}

std::size_t PeoplePooling::place(std::size_t i) const {
  return static_cast<std::size_t>(std::find(free_.begin(), free_.end(), rows_.gaps() + i) - free_.begin());
}

double PeoplePooling::covariance(std::size_t i, std::size_t j) const {
  return covariance_[place(i) * free_.size() + place(j)];
}

double PeoplePooling::quadratic(std::span<const double> a, std::span<const double> b) const {
  double out = 0;
  for (std::size_t i = 0; i < a.size(); ++i)
    for (std::size_t j = 0; j < b.size(); ++j) out += a[i] * covariance_[i * b.size() + j] * b[j];
  return out;
}

double PeoplePooling::se(const std::function<double(const PeoplePooling&)>& of) {
  constexpr double h = 1e-5;
  std::vector<double> slope(free_.size());
  for (std::size_t j = 0; j < free_.size(); ++j) {
    double& parameter = at_[free_[j]];
    const double kept = parameter;
    parameter = kept + h;
    slope[j] = of(*this) / (2 * h);
    parameter = kept - h;
    slope[j] -= of(*this) / (2 * h);
    parameter = kept;
  }
  return std::sqrt(quadratic(slope, slope));
}

LevelThresholds PeoplePooling::thresholds() const {
  return level_thresholds(std::span(at_).first(rows_.gaps()), 0, rows_.levels, level_);
}

PersonMoments PeoplePooling::spread() const {
  const double a = std::exp(parameter(PeopleAt::LogSdA)), b = std::exp(parameter(PeopleAt::LogSdB));
  return {{}, a * a, std::tanh(parameter(PeopleAt::ArtanhR)) * a * b, b * b};
}

std::vector<PersonMoments> PeoplePooling::whole_moments() {
  constexpr double h = 1e-4;
  auto out = moments();
  std::vector<double> x = free_values(), ignored(x.size());
  std::vector<std::vector<double>> alpha(out.size(), std::vector<double>(x.size())), beta = alpha;
  for (std::size_t j = 0; j < x.size(); ++j) {
    const double kept = x[j];
    for (const double sign : {1.0, -1.0}) {
      x[j] = kept + sign * h;
      deviance(x, ignored);
      for (std::size_t i = 0; i < out.size(); ++i) {
        alpha[i][j] += sign * moments()[i].mean[0] / (2 * h);
        beta[i][j] += sign * moments()[i].mean[1] / (2 * h);
      }
    }
    x[j] = kept;
  }
  deviance(x, ignored);
  for (std::size_t i = 0; i < out.size(); ++i) {
    out[i].var_alpha += quadratic(alpha[i], alpha[i]);
    out[i].cov += quadratic(alpha[i], beta[i]);
    out[i].var_beta += quadratic(beta[i], beta[i]);
  }
  return out;
}

}  // namespace stats
