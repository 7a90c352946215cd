#include "stats/inference/nonlinear_fit.hpp"

#include <gsl/gsl_errno.h>
#include <gsl/gsl_multifit_nlinear.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <memory>
#include <new>
#include <stdexcept>

#include "stats/gsl_errors.hpp"
#include "stats/inference/linear_fit.hpp"

namespace stats {

namespace {

constexpr double infinite = std::numeric_limits<double>::infinity();
constexpr double converged_offset = 1e-6;

bool all_finite(std::span<const double> values) {
  return std::all_of(values.begin(), values.end(), [](double v) { return std::isfinite(v); });
}

/// A place, its residuals, and the linear problem around it.
struct Place {
  std::vector<double> parameters;
  double rss = infinite;
  std::vector<double> step;  ///< Gauss-Newton's
  std::vector<double> standard_errors;
  double tangential = infinite;  ///< length of the residuals' projection on the tangent plane
  double rounding = 0;           ///< part of it that rounding of the model alone makes
  double df = 0;

  /// Residuals of rounding alone have no direction.
  bool converged() const {
    return std::isfinite(rss) && tangential <= converged_offset * std::sqrt(rss) + rounding;
  }
};

/// The model around one place. An infinite sum where the model is not finite, an infinite projection where
/// its derivatives are not or depend on each other.
Place place(const NonlinearModel& model, std::vector<double> parameters) {
  const auto n = model.n_points, p = model.n_parameters;
  Place out;
  out.parameters = std::move(parameters);
  std::vector<double> residuals(n), jacobian(n * p);
  model.residuals(out.parameters, residuals);
  if (!all_finite(residuals)) return out;
  out.rss = 0;
  for (const double r : residuals) out.rss += r * r;
  model.jacobian(out.parameters, jacobian);
  if (!all_finite(jacobian)) return out;
  std::vector<std::vector<double>> columns(p, std::vector<double>(n));
  for (std::size_t j = 0; j < p; ++j) {
    double square = 0;
    for (std::size_t i = 0; i < n; ++i) {
      columns[j][i] = jacobian[i * p + j];
      square += columns[j][i] * columns[j][i];
    }
    out.rounding = std::max(out.rounding, 1e-14 * std::abs(out.parameters[j]) * std::sqrt(square));
  }
  const auto linear = fit_linear(columns, residuals, false);
  if (!linear) return out;
  out.step = linear->coefficients;
  for (auto& s : out.step) s = -s;
  out.standard_errors = linear->standard_errors;
  out.df = linear->df;
  out.tangential = std::sqrt(std::max(out.rss - linear->rss, 0.0));
  // Near the minimum the difference of two sums has no digits left; r2 comes from more.
  if (linear->r2) out.tangential = std::sqrt(std::max(*linear->r2, 0.0) * out.rss);
  return out;
}

/// Gauss-Newton steps, halved where they lead up. Close to the minimum the sum of squares is flat to
/// rounding: there the projection decides.
Place polished(const NonlinearModel& model, Place at) {
  constexpr int most_steps = 60, most_halvings = 30;
  for (int i = 0; i < most_steps && !at.step.empty() && at.tangential > 0; ++i) {
    bool better = false;
    double share = 1;
    for (int halving = 0; halving < most_halvings && !better; ++halving, share /= 2) {
      auto moved = at.parameters;
      for (std::size_t j = 0; j < moved.size(); ++j) moved[j] += share * at.step[j];
      auto next = place(model, std::move(moved));
      better = next.rss < at.rss * (1 - 1e-10) ||
               (next.rss <= at.rss * (1 + 1e-10) && next.tangential < at.tangential / 2);
      if (better) at = std::move(next);
    }
    if (!better) break;
  }
  return at;
}

int residuals_for_gsl(const gsl_vector* x, void* context, gsl_vector* f) {
  const auto& model = *static_cast<const NonlinearModel*>(context);
  std::vector<double> at(model.n_parameters), out(model.n_points);
  for (std::size_t i = 0; i < at.size(); ++i) at[i] = gsl_vector_get(x, i);
  model.residuals(at, out);
  // Outside its domain the model is far from the data, which turns the step down.
  const bool inside = all_finite(out);
  for (std::size_t i = 0; i < out.size(); ++i) gsl_vector_set(f, i, inside ? out[i] : 1e100);
  return GSL_SUCCESS;
}

int jacobian_for_gsl(const gsl_vector* x, void* context, gsl_matrix* jacobian) {
  const auto& model = *static_cast<const NonlinearModel*>(context);
  std::vector<double> at(model.n_parameters), out(model.n_points * model.n_parameters);
  for (std::size_t i = 0; i < at.size(); ++i) at[i] = gsl_vector_get(x, i);
  model.jacobian(at, out);
  if (!all_finite(out)) return GSL_EBADFUNC;
  for (std::size_t i = 0; i < model.n_points; ++i) {
    for (std::size_t j = 0; j < at.size(); ++j)
      gsl_matrix_set(jacobian, i, j, out[i * model.n_parameters + j]);
  }
  return GSL_SUCCESS;
}

struct Free {
  void operator()(gsl_multifit_nlinear_workspace* work) const { gsl_multifit_nlinear_free(work); }
};

/// Where one of GSL's methods stops; the caller judges the place. Empty when it failed.
std::vector<double> solve(const NonlinearModel& model, std::span<const double> start,
                          const gsl_multifit_nlinear_trs* method, const gsl_multifit_nlinear_scale* scale) {
  auto parameters = gsl_multifit_nlinear_default_parameters();
  parameters.trs = method;
  parameters.scale = scale;
  const std::unique_ptr<gsl_multifit_nlinear_workspace, Free> work(gsl_multifit_nlinear_alloc(
      gsl_multifit_nlinear_trust, &parameters, model.n_points, model.n_parameters));
  if (!work) throw std::bad_alloc();
  gsl_multifit_nlinear_fdf problem{};
  problem.f = residuals_for_gsl;
  problem.df = jacobian_for_gsl;
  problem.n = model.n_points;
  problem.p = model.n_parameters;
  problem.params = const_cast<NonlinearModel*>(&model);
  const auto point = gsl_vector_const_view_array(start.data(), start.size());
  if (gsl_multifit_nlinear_init(&point.vector, &problem, work.get()) != GSL_SUCCESS) return {};
  int why = 0;
  gsl_multifit_nlinear_driver(1000, 1e-12, 1e-15, 0, nullptr, nullptr, &why, work.get());
  // Whatever the driver says, the place counts only if it proves to be a minimum.
  std::vector<double> out;
  const auto* end = gsl_multifit_nlinear_position(work.get());
  for (std::size_t i = 0; i < model.n_parameters; ++i) out.push_back(gsl_vector_get(end, i));
  return all_finite(out) ? out : std::vector<double>{};
}

/// Where the methods stop from one start, the least sum of squares first.
std::vector<Place> ends(const NonlinearModel& model, std::span<const double> start, std::size_t& runs) {
  const std::array methods{gsl_multifit_nlinear_trs_lm, gsl_multifit_nlinear_trs_lmaccel,
                           gsl_multifit_nlinear_trs_dogleg, gsl_multifit_nlinear_trs_ddogleg,
                           gsl_multifit_nlinear_trs_subspace2D};
  const std::array scales{gsl_multifit_nlinear_scale_more, gsl_multifit_nlinear_scale_levenberg,
                          gsl_multifit_nlinear_scale_marquardt};
  std::vector<Place> out;
  for (const auto* method : methods) {
    if (model.n_parameters < 2 && method == gsl_multifit_nlinear_trs_subspace2D) continue;
    for (const auto* scale : scales) {
      ++runs;
      auto end = solve(model, start, method, scale);
      if (!end.empty()) out.push_back(place(model, std::move(end)));
    }
  }
  std::sort(out.begin(), out.end(), [](const Place& a, const Place& b) { return a.rss < b.rss; });
  return out;
}

/// The best minimum that the methods reach from one start; a place without convergence when none does.
Place search(const NonlinearModel& model, std::span<const double> start, std::size_t& runs) {
  Place best;
  for (auto& end : ends(model, start, runs)) {
    // Most methods stop at the same place.
    if (best.converged() && std::abs(end.rss - best.rss) <= 1e-6 * best.rss) continue;
    auto found = polished(model, std::move(end));
    const bool proven = found.converged(), had = best.converged();
    if ((proven && !had) || (proven == had && found.rss < best.rss)) best = std::move(found);
  }
  return best;
}

void require_sizes(const NonlinearModel& model, std::span<const double> start) {
  if (!model.residuals || !model.jacobian) throw std::invalid_argument("a model needs both functions");
  if (model.n_parameters == 0 || start.size() != model.n_parameters)
    throw std::invalid_argument("the start must have a value for each parameter");
}

}  // namespace

Result<NonlinearFit> fit_nonlinear(const NonlinearModel& model, std::span<const double> start) {
  use_gsl_codes();
  require_sizes(model, start);
  if (model.n_points < model.n_parameters) return Refusal{"fewer points than parameters"};
  std::vector<double> residuals(model.n_points);
  model.residuals(start, residuals);
  if (!all_finite(start) || !all_finite(residuals)) return Refusal{"the model is not finite at the start"};
  NonlinearFit out;
  const auto best = search(model, start, out.runs);
  if (!std::isfinite(best.rss) || !best.converged()) return Refusal{"the least squares did not converge"};
  out.parameters = best.parameters;
  out.standard_errors = best.standard_errors;
  out.rss = best.rss;
  out.df = best.df;
  if (out.df > 0) out.residual_sd = std::sqrt(out.rss / out.df);
  out.relative_offset = best.rss > 0 ? best.tangential / std::sqrt(best.rss) : 0;
  return out;
}

Result<NonlinearFit> fit_nonlinear(const NonlinearModel& model, std::span<const std::vector<double>> starts) {
  Result<NonlinearFit> best = Refusal{"no start was given"};
  std::size_t runs = 0;
  for (const auto& start : starts) {
    auto fit = fit_nonlinear(model, start);
    if (fit) runs += fit->runs;
    if (!best || (fit && fit->rss < best->rss)) best = std::move(fit);
  }
  if (!best) return best;
  NonlinearFit out = *best;
  out.runs = runs;
  return out;
}

}  // namespace stats
