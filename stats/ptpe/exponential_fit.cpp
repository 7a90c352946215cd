#include "stats/ptpe/exponential_fit.hpp"

#include <gsl/gsl_errno.h>
#include <gsl/gsl_multifit_nlinear.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>
#include <stdexcept>
#include <vector>

#include "stats/gsl_errors.hpp"

namespace stats {

namespace {

/// The data scaled for the fit v = A exp(B u): u in [-1, 1] about the middle of the range of x, and |v| <= 1.
struct Scaled {
  std::vector<double> u, v, w;
  double x_mean = 0, x_scale = 1, y_scale = 1;
  bool weighted = false;
};

struct Candidate {
  double A = 0, B = 0;
  double rss = std::numeric_limits<double>::infinity();
};

double residual_sum(const Scaled& data, double A, double B) {
  double sum = 0;
  for (std::size_t i = 0; i < data.u.size(); ++i) {
    const double r = A * std::exp(B * data.u[i]) - data.v[i];
    sum += data.w[i] * r * r;
  }
  return sum;
}

/// The best A for a given B, by linear least squares.
Candidate with_best_amplitude(const Scaled& data, double B) {
  double num = 0, den = 0;
  for (std::size_t i = 0; i < data.u.size(); ++i) {
    const double e = std::exp(B * data.u[i]);
    num += data.w[i] * data.v[i] * e;
    den += data.w[i] * e * e;
  }
  return {num / den, B, residual_sum(data, num / den, B)};
}

/// Slope of log|v| on u over the values that have the sign of the sum of v. Each is weighted by w v^2, since
/// the variance of log|v| is proportional to 1 / (w v^2).
double log_linear_rate(const Scaled& data) {
  double balance = 0;
  for (const double v : data.v) balance += v;
  double s = 0, su = 0, sl = 0;
  for (std::size_t i = 0; i < data.u.size(); ++i) {
    if (data.v[i] * balance <= 0) continue;
    const double w = data.w[i] * data.v[i] * data.v[i];
    s += w;
    su += w * data.u[i];
    sl += w * std::log(std::abs(data.v[i]));
  }
  if (s <= 0) return 0;
  double suu = 0, sul = 0;
  for (std::size_t i = 0; i < data.u.size(); ++i) {
    if (data.v[i] * balance <= 0) continue;
    const double w = data.w[i] * data.v[i] * data.v[i], du = data.u[i] - su / s;
    suu += w * du * du;
    sul += w * du * (std::log(std::abs(data.v[i])) - sl / s);
  }
  return suu > 0 ? sul / suu : 0;
}

/// Largest accepted |B|. Between u = -1 and 1 the curve then changes by a factor of exp(2 * 60), 1e52.
constexpr double largest_rate = 60;

/// Starting points of the solver: the local minima, on a coarse grid of B, of the sum of squares with the
/// best A, and the log-linear estimate.
std::vector<Candidate> starts(const Scaled& data) {
  constexpr std::array steps{0.0, 0.25, 0.5, 1.0, 2.0, 4.0, 8.0, 16.0, 32.0};
  std::vector<Candidate> profile;
  for (std::size_t i = steps.size() - 1; i > 0; --i) profile.push_back(with_best_amplitude(data, -steps[i]));
  for (const double step : steps) profile.push_back(with_best_amplitude(data, step));
  std::vector<Candidate> found{
      with_best_amplitude(data, std::clamp(log_linear_rate(data), -largest_rate, largest_rate))};
  for (std::size_t i = 0; i < profile.size(); ++i) {
    const bool left = i == 0 || profile[i].rss <= profile[i - 1].rss;
    const bool right = i + 1 == profile.size() || profile[i].rss <= profile[i + 1].rss;
    if (left && right) found.push_back(profile[i]);
  }
  return found;
}

int residuals(const gsl_vector* p, void* context, gsl_vector* f) {
  const auto& data = *static_cast<const Scaled*>(context);
  const double A = gsl_vector_get(p, 0), B = gsl_vector_get(p, 1);
  for (std::size_t i = 0; i < data.u.size(); ++i) {
    gsl_vector_set(f, i, A * std::exp(B * data.u[i]) - data.v[i]);
  }
  return GSL_SUCCESS;
}

int jacobian(const gsl_vector* p, void* context, gsl_matrix* J) {
  const auto& data = *static_cast<const Scaled*>(context);
  const double A = gsl_vector_get(p, 0), B = gsl_vector_get(p, 1);
  for (std::size_t i = 0; i < data.u.size(); ++i) {
    const double e = std::exp(B * data.u[i]);
    gsl_matrix_set(J, i, 0, e);
    gsl_matrix_set(J, i, 1, A * data.u[i] * e);
  }
  return GSL_SUCCESS;
}

/// GSL's solver for one data set; can be run from any number of starts.
class Solver {
 public:
  explicit Solver(Scaled& data) : data_(data) {
    use_gsl_codes();
    const auto parameters = gsl_multifit_nlinear_default_parameters();
    work_.reset(gsl_multifit_nlinear_alloc(gsl_multifit_nlinear_trust, &parameters, data.u.size(), 2));
    if (!work_) throw std::bad_alloc();
    problem_.f = residuals;
    problem_.df = jacobian;
    problem_.n = data.u.size();
    problem_.p = 2;
    problem_.params = &data;
  }

  /// The point where the solver stops, which the caller must check. An infinite sum of squares if the solver
  /// failed.
  Candidate run(const Candidate& start) {
    double at[2] = {start.A, start.B};
    const auto point = gsl_vector_const_view_array(at, 2);
    const auto weights = gsl_vector_const_view_array(data_.w.data(), data_.w.size());
    if (gsl_multifit_nlinear_winit(&point.vector, &weights.vector, &problem_, work_.get())) return {};
    int why = 0;
    const int code = gsl_multifit_nlinear_driver(200, 1e-13, 1e-14, 0, nullptr, nullptr, &why, work_.get());
    // At the minimum, rounding makes the solver report "no progress".
    if (code != GSL_SUCCESS && code != GSL_ENOPROG && code != GSL_EMAXITER) return {};
    const auto* end = gsl_multifit_nlinear_position(work_.get());
    const double A = gsl_vector_get(end, 0), B = gsl_vector_get(end, 1);
    return {A, B, residual_sum(data_, A, B)};
  }

 private:
  struct Free {
    void operator()(gsl_multifit_nlinear_workspace* work) const { gsl_multifit_nlinear_free(work); }
  };
  Scaled& data_;
  gsl_multifit_nlinear_fdf problem_{};
  std::unique_ptr<gsl_multifit_nlinear_workspace, Free> work_;
};

/// The parts of J^T W J and J^T W r at a candidate (A, B), with the Jacobian J, the weights W and the
/// residuals r.
struct NormalEquations {
  double aa = 0, ab = 0, bb = 0, ga = 0, gb = 0;
  double determinant() const { return aa * bb - ab * ab; }
};

NormalEquations normal_equations(const Scaled& data, const Candidate& at) {
  NormalEquations n;
  for (std::size_t i = 0; i < data.u.size(); ++i) {
    const double e = std::exp(at.B * data.u[i]), da = e, db = at.A * data.u[i] * e;
    const double r = at.A * e - data.v[i];
    n.aa += data.w[i] * da * da;
    n.ab += data.w[i] * da * db;
    n.bb += data.w[i] * db * db;
    n.ga += data.w[i] * da * r;
    n.gb += data.w[i] * db * r;
  }
  return n;
}

/// Squared length of the residuals' projection onto the tangent plane, g^T (J^T W J)^-1 g.
double tangential(const NormalEquations& n) {
  return (n.bb * n.ga * n.ga - 2 * n.ab * n.ga * n.gb + n.aa * n.gb * n.gb) / n.determinant();
}

bool is_minimum(const Scaled& data, const Candidate& at) {
  if (!std::isfinite(at.rss)) return false;
  const auto n = normal_equations(data, at);
  if (!(n.determinant() > 1e-14 * n.aa * n.bb)) return false;
  double total = 0;
  for (std::size_t i = 0; i < data.v.size(); ++i) total += data.w[i] * data.v[i] * data.v[i];
  // Residuals that are only rounding need not be orthogonal to the tangent plane.
  const double rounding = 1e-28 * total;
  return tangential(n) <= 1e-14 * at.rss + rounding;
}

Result<Scaled> clean(std::span<const double> x, std::span<const double> y, std::span<const double> weights) {
  if (x.size() != y.size() || (!weights.empty() && weights.size() != x.size())) {
    throw std::invalid_argument(
        "fit_exponential: x, y and weights differ in length; give one y for each x, and one weight for each "
        "or none");
  }
  Scaled data;
  data.weighted = !weights.empty();
  for (std::size_t i = 0; i < x.size(); ++i) {
    const double w = weights.empty() ? 1 : weights[i];
    if (std::isnan(x[i]) || std::isnan(y[i]) || std::isnan(w)) continue;
    if (std::isinf(x[i]) || std::isinf(y[i])) return Refusal{"a value is infinite"};
    if (!(w > 0) || std::isinf(w)) return Refusal{"a weight is not positive and finite"};
    data.u.push_back(x[i]);
    data.v.push_back(y[i]);
    data.w.push_back(w);
  }
  if (data.u.empty()) return Refusal{"no points"};
  if (data.u.size() < 2) return Refusal{"fewer points than parameters"};
  const auto [x_low, x_high] = std::minmax_element(data.u.begin(), data.u.end());
  if (*x_low == *x_high) return Refusal{"all x are equal: a and b are not identifiable"};
  data.x_mean = *x_low + (*x_high - *x_low) / 2;
  data.x_scale = (*x_high - *x_low) / 2;
  data.y_scale = 0;
  for (const double v : data.v) data.y_scale = std::max(data.y_scale, std::abs(v));
  if (data.y_scale == 0) return Refusal{"all y are zero: b is not identifiable"};
  for (auto& u : data.u) u = (u - data.x_mean) / data.x_scale;
  for (auto& v : data.v) v /= data.y_scale;
  return data;
}

std::optional<double> determination(const Scaled& data, double rss) {
  if (data.weighted) return std::nullopt;
  double mean = 0, total = 0;
  for (const double v : data.v) mean += v / static_cast<double>(data.v.size());
  for (const double v : data.v) total += (v - mean) * (v - mean);
  if (!(total > 1e-28 * static_cast<double>(data.v.size()))) return std::nullopt;
  return 1 - rss / total;
}

/// Converts back to a = y_scale A exp(-B x_mean / x_scale) and b = B / x_scale; covariance by the chain rule.
ExponentialFit unscaled(const Scaled& data, const Candidate& best) {
  ExponentialFit fit;
  fit.n = static_cast<int>(data.u.size());
  fit.b = best.B / data.x_scale;
  const double per_amplitude = data.y_scale * std::exp(-fit.b * data.x_mean);
  fit.a = best.A * per_amplitude;
  fit.rss = best.rss * data.y_scale * data.y_scale;
  fit.r2 = determination(data, best.rss);
  if (fit.df() < 1) return fit;
  const auto n = normal_equations(data, best);
  const double scale = best.rss / fit.df() / n.determinant();
  const double caa = scale * n.bb, cab = -scale * n.ab, cbb = scale * n.aa;
  const double da = per_amplitude, db = -fit.a * data.x_mean / data.x_scale;
  fit.covariance = {da * da * caa + 2 * da * db * cab + db * db * cbb, (da * cab + db * cbb) / data.x_scale,
                    cbb / (data.x_scale * data.x_scale)};
  return fit;
}

}  // namespace

double ExponentialFit::value(double x) const { return a * std::exp(b * x); }

Result<ExponentialFit> fit_exponential(std::span<const double> x, std::span<const double> y,
                                       std::span<const double> weights) {
  auto cleaned = clean(x, y, weights);
  if (!cleaned) return Refusal{cleaned.reason()};
  Scaled data = *cleaned;
  Solver solver(data);
  Candidate best;
  for (const auto& start : starts(data)) {
    const auto end = solver.run(start);
    if (end.rss < best.rss) best = end;
  }
  if (!std::isfinite(best.rss) || std::abs(best.B) > largest_rate) {
    return Refusal{"no finite minimum: the sum of squares falls for ever steeper curves"};
  }
  if (!is_minimum(data, best)) return Refusal{"the least squares did not converge"};
  const auto fit = unscaled(data, best);
  if (!std::isfinite(fit.a) || !std::isfinite(fit.b) || !std::isfinite(fit.rss)) {
    return Refusal{"a, b or the sum of squares is beyond double precision"};
  }
  return fit;
}

}  // namespace stats
