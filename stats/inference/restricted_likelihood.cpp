#include "stats/inference/restricted_likelihood.hpp"

#include <cmath>
#include <map>

namespace stats {

namespace {

using Vector = std::vector<double>;

/// A residual below this share of y'y counts as rounding.
constexpr double least_residual = 1e-12;

/// matrix += factor * v v'.
void add_outer(Vector& matrix, double factor, const Vector& v) {
  const std::size_t n = v.size();
  for (std::size_t i = 0; i < n; ++i) {
    const double scaled = factor * v[i];
    if (scaled == 0) continue;
    for (std::size_t j = 0; j < n; ++j) matrix[i * n + j] += scaled * v[j];
  }
}

/// The first q rows and columns of a matrix of size q + 1.
Vector without_last(const Vector& matrix, std::size_t q) {
  Vector out;
  for (std::size_t i = 0; i < q; ++i) {
    const auto row = matrix.begin() + static_cast<std::ptrdiff_t>(i * (q + 1));
    out.insert(out.end(), row, row + static_cast<std::ptrdiff_t>(q));
  }
  return out;
}

double quadratic(const Vector& matrix, const Vector& v) {
  double sum = 0;
  for (std::size_t i = 0; i < v.size(); ++i) {
    for (std::size_t j = 0; j < v.size(); ++j) sum += v[i] * matrix[i * v.size() + j] * v[j];
  }
  return sum;
}

Vector product(const Vector& a, const Vector& b, std::size_t n) {
  Vector out(n * n);
  for (std::size_t i = 0; i < n; ++i) {
    for (std::size_t k = 0; k < n; ++k) {
      for (std::size_t j = 0; j < n; ++j) out[i * n + j] += a[i * n + k] * b[k * n + j];
    }
  }
  return out;
}

}  // namespace

RestrictedLikelihood::RestrictedLikelihood(std::span<const Vector> columns, std::span<const double> y,
                                           std::span<const int> participant, std::span<const int> thing)
    : n_(static_cast<int>(y.size())), q_(columns.size()), gram_((q_ + 1) * (q_ + 1)) {
  std::map<int, std::map<int, Group>> people;
  for (std::size_t i = 0; i < y.size(); ++i) {
    Vector row;
    for (const auto& column : columns) row.push_back(column[i]);
    row.push_back(y[i]);
    add_outer(gram_, 1, row);
    Group& group = people[participant[i]][thing[i]];
    group.n += 1;
    group.sums.resize(q_ + 1);
    for (std::size_t k = 0; k <= q_; ++k) group.sums[k] += row[k];
  }
  for (auto& [person, things] : people) {
    auto& groups = people_.emplace_back();
    for (auto& [number, group] : things) groups.push_back(std::move(group));
  }
}

/// Adds one participant's terms to `sums`. theta_0 and theta_1 are the variances of the effects of the
/// participant and of the participant with each thing, divided by the residual variance. With Z assigning
/// rows to things, the covariance of the participant's rows divided by the residual variance is V = A +
/// theta_0 1 1', where A = I + theta_1 Z Z'. Woodbury's identity inverts both.
void RestrictedLikelihood::add_person(const std::vector<Group>& groups, std::array<double, 2> theta,
                                      Sums& sums) const {
  Vector all(q_ + 1);  // 1' A^-1 (X y)
  double weight = 0;   // 1' A^-1 1
  for (const Group& group : groups) {
    const double shrink = 1 / (1 + group.n * theta[1]);
    weight += group.n * shrink;
    for (std::size_t k = 0; k <= q_; ++k) all[k] += shrink * group.sums[k];
    add_outer(sums.gram, -theta[1] * shrink, group.sums);
    sums.log_det_v += std::log1p(group.n * theta[1]);
  }
  const double scale = 1 / (1 + theta[0] * weight);
  sums.log_det_v += std::log1p(theta[0] * weight);
  add_outer(sums.gram, -theta[0] * scale, all);
  add_outer(sums.spread[0], scale * scale, all);
  sums.trace[0] += scale * weight;
  Vector own(q_ + 1);
  for (const Group& group : groups) {
    const double shrink = 1 / (1 + group.n * theta[1]), shared = theta[0] * scale * group.n;
    for (std::size_t k = 0; k <= q_; ++k) own[k] = shrink * (group.sums[k] - shared * all[k]);
    add_outer(sums.spread[1], 1, own);
    sums.trace[1] += shrink * group.n * (1 - shared * shrink);
  }
}

std::optional<RestrictedLikelihood::At> RestrictedLikelihood::at(std::array<double, 2> lambda) const {
  const std::array<double, 2> theta{lambda[0] * lambda[0], lambda[1] * lambda[1]};
  Sums sums{gram_, 0, {}, {Vector(gram_.size()), Vector(gram_.size())}};
  for (const auto& groups : people_) add_person(groups, theta, sums);
  const auto factor = Cholesky::of(without_last(sums.gram, q_));
  if (!factor) return std::nullopt;
  Vector rest(sums.gram.end() - static_cast<std::ptrdiff_t>(q_ + 1), sums.gram.end());
  At out;
  out.residual = rest.back();
  rest.pop_back();
  out.beta = factor->solve(rest);
  for (std::size_t i = 0; i < q_; ++i) out.residual -= out.beta[i] * rest[i];
  if (!(out.residual > least_residual * gram_.back())) return std::nullopt;
  out.inverse = factor->inverse();
  out.log_determinants = sums.log_det_v + factor->log_determinant();
  Vector contrast;  // c with (X y) c = y - X beta
  for (const double b : out.beta) contrast.push_back(-b);
  contrast.push_back(1);
  for (std::size_t k = 0; k < 2; ++k) {
    const Vector spread = without_last(sums.spread[k], q_);
    double trace = sums.trace[k];
    for (std::size_t i = 0; i < spread.size(); ++i) trace -= out.inverse[i] * spread[i];
    out.slope[k] = 2 * lambda[k] * trace;
    out.residual_slope[k] = -2 * lambda[k] * quadratic(sums.spread[k], contrast);
    out.inverse_slope[k] = product(product(out.inverse, spread, q_), out.inverse, q_);
    for (double& v : out.inverse_slope[k]) v *= 2 * lambda[k];
  }
  return out;
}

}  // namespace stats
