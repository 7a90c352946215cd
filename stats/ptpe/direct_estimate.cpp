#include <gsl/gsl_cdf.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <iterator>
#include <map>
#include <set>
#include <stdexcept>
#include <string>
#include <vector>

#include "stats/gsl_errors.hpp"
#include "stats/ptpe/direct_fit.hpp"

namespace stats {

namespace {

/// Fits the ratings with one weight for each participant.
using Fitter = std::function<Result<DirectFit>(std::span<const double>)>;

/// The fits without each participant in turn, or the reason if one of them is refused.
Result<std::vector<DirectFit>> leave_one_out(int n, const Fitter& fitter) {
  if (n < least_participants) {
    return Refusal{"an interval over participants needs at least " + std::to_string(least_participants) +
                   " of them, not " + std::to_string(n)};
  }
  std::vector<DirectFit> fits;
  for (int left_out = 0; left_out < n; ++left_out) {
    std::vector<double> weights(static_cast<std::size_t>(n), 1.0);
    weights[static_cast<std::size_t>(left_out)] = 0;
    const auto fit = fitter(weights);
    if (!fit) return Refusal{"one participant decides whether there is a fit: without them " + fit.reason()};
    fits.push_back(*fit);
  }
  return fits;
}

CurveSpread spread_of(const DirectFit& fit, const std::vector<DirectFit>& without, double confidence) {
  std::vector<Curve> curves;
  for (const auto& f : without) curves.push_back(f.curve);
  return jackknife_curve(fit.curve, curves, confidence);
}

Result<LackOfFit> lack_of_fit(const DirectFit& fit, const std::vector<DirectFit>& without) {
  use_gsl_codes();
  std::vector<double> m, q;
  for (const auto& f : without) {
    m.push_back(f.m);
    q.push_back(f.q);
  }
  const double mm = jackknife_covariance(m, m), mq = jackknife_covariance(m, q),
               qq = jackknife_covariance(q, q);
  const double determinant = mm * qq - mq * mq, n = static_cast<double>(m.size());
  // If the participants' estimates are equal, their variance is only rounding, and the test's F would be
  // meaningless.
  const auto no_spread = [](double variance, double value) { return !(variance > 1e-18 * value * value); };
  if (no_spread(mm, fit.m) || no_spread(qq, fit.q) || !(determinant > 1e-12 * mm * qq))
    return Refusal{"the participants agree: m and q have no spread"};
  const double t2 = (qq * fit.m * fit.m - 2 * mq * fit.m * fit.q + mm * fit.q * fit.q) / determinant;
  LackOfFit test;
  test.m = fit.m;
  test.q = fit.q;
  test.df2 = static_cast<int>(m.size()) - 2;
  test.f = t2 * (n - 2) / (2 * (n - 1));
  test.p = gsl_cdf_fdist_Q(test.f, 2, n - 2);
  return test;
}

ResampledCurves resampled_fits(const DirectModel& model, const DirectFit& fit,
                               const BootstrapOptions& options, ResampleRange range) {
  ResampledCurves out;
  for (int i = range.first; i < range.first + range.count; ++i) {
    const auto weights = resample_weights(model.participants(), options.seed, static_cast<std::uint64_t>(i));
    const auto drawn = model.fit(weights, &fit);
    out.emplace_back();
    if (drawn) out.back() = std::array{drawn->curve.a(), drawn->curve.b};
    if (options.progress) options.progress(i + 1);
  }
  return out;
}

Result<PilotSpread> bootstrap(const DirectModel& model, const DirectFit& fit, const BootstrapOptions& options,
                              const ResampledCurves* drawn) {
  if (options.resamples < 1) return Refusal{"no resamples were asked for"};
  const int n = model.participants();
  if (!drawn)
    return pilot_spread(resampled_fits(model, fit, options, {0, options.resamples}), n, options.confidence);
  if (static_cast<int>(drawn->size()) != options.resamples)
    throw std::invalid_argument("estimate_direct: " + std::to_string(drawn->size()) + " curves for " +
                                std::to_string(options.resamples) + " resamples; give one for each");
  return pilot_spread(*drawn, n, options.confidence);
}

void refuse_spread(DirectEstimate& estimate, const std::string& reason) {
  estimate.jackknife = Refusal{reason};
  estimate.bootstrap = Refusal{reason};
  estimate.lack_of_fit = Refusal{reason};
  estimate.form = Refusal{reason};
}

/// Excludes the settings whose nominal mean frame rate is above far_factor times the curve, unless no fit is
/// possible without them.
void leave_out_far_above(Reach& reach, double level) {
  const auto inner = DirectModel(reach.kept, level).fit();
  if (!inner) return;
  std::set<std::pair<double, double>> far;
  std::vector<PilotObservation> near;
  for (const auto& o : reach.kept) {
    if (o.nominal_mu <= far_factor * inner->curve.mu(o.nominal_delta)) {
      near.push_back(o);
    } else {
      far.insert({o.nominal_mu, o.nominal_delta});
    }
  }
  if (far.empty() || !DirectModel(near, level).fit()) return;
  reach.kept = std::move(near);
  reach.far_above = static_cast<int>(far.size());
}

}  // namespace

Reach within_reach(std::span<const PilotObservation> observations, double level) {
  Reach out;
  out.kept.assign(observations.begin(), observations.end());
  const auto whole = DirectModel(observations, level).fit();
  if (!whole) return out;
  // Lowest and highest mean frame rate, by nominal delta (standard deviation).
  std::map<double, std::array<double, 2>> shown;
  for (const auto& o : observations) {
    auto& [low, high] = shown.try_emplace(o.nominal_delta, std::array{o.mu, o.mu}).first->second;
    low = std::min(low, o.mu);
    high = std::max(high, o.mu);
  }
  // By nominal delta: distance in log mu between the curve and the frame rates shown; 0 within reach.
  std::map<double, double> beyond;
  std::vector<double> distances;
  for (const auto& [delta, range] : shown) {
    const double mu = whole->curve.mu(delta);
    const double distance = std::max(std::log(mu / range[1]), std::log(range[0] / mu));
    beyond[delta] = distance > std::log(reach_margin) ? distance : 0;
    distances.push_back(beyond[delta]);
    out.in_reach += beyond[delta] == 0;
  }
  std::sort(distances.begin(), distances.end());
  const double farthest = distances[std::min<std::size_t>(2, distances.size() - 1)];
  for (const auto& [delta, distance] : beyond)
    if (distance > farthest) out.left_out.push_back(delta);
  std::erase_if(out.kept, [&](const auto& o) { return beyond[o.nominal_delta] > farthest; });
  leave_out_far_above(out, level);
  return out;
}

std::vector<double> DirectEstimate::in_reach_of(std::span<const double> deltas) const {
  std::vector<double> kept;
  std::set_difference(deltas.begin(), deltas.end(), out_of_reach.begin(), out_of_reach.end(),
                      std::back_inserter(kept));
  return kept;
}

ResampledCurves resample_direct(std::span<const PilotObservation> observations, double level,
                                const BootstrapOptions& options, ResampleRange range) {
  const DirectModel model(within_reach(observations, level).kept, level);
  if (model.participants() == 0) return {};
  const auto fit = model.fit();
  return fit ? resampled_fits(model, *fit, options, range) : ResampledCurves();
}

DirectEstimate estimate_direct(std::span<const PilotObservation> observations, double level,
                               const BootstrapOptions& options, const ResampledCurves* drawn) {
  DirectEstimate out;
  const Reach reach = within_reach(observations, level);
  out.out_of_reach = reach.left_out;
  out.in_reach = reach.in_reach;
  out.far_above = reach.far_above;
  const DirectModel model(reach.kept, level);
  if (model.participants() == 0) {
    out.fit = Refusal{"no ratings"};
    out.straight = Refusal{"no ratings"};
  } else {
    out.fit = model.fit();
    out.straight = model.fit_straight();
  }
  const int n = model.participants();
  if (!out.fit) {
    refuse_spread(out, out.fit.reason());
  } else {
    const auto without = leave_one_out(n, [&](std::span<const double> w) { return model.fit(w, &*out.fit); });
    if (without) {
      out.jackknife = spread_of(*out.fit, *without, options.confidence);
      out.lack_of_fit = lack_of_fit(*out.fit, *without);
      out.form = form_test(reach.kept, out.fit->curve, level, options.confidence);
      out.bootstrap = bootstrap(model, *out.fit, options, drawn);
    } else {
      refuse_spread(out, without.reason());
    }
  }
  // A curve of another form can leave the exponential without a fit. The test of the form then begins at the
  // straight form's curve.
  if (!out.jackknife && out.straight)
    out.form = form_test(reach.kept, out.straight->curve, level, options.confidence);
  if (!out.straight) {
    out.straight_jackknife = Refusal{out.straight.reason()};
    return out;
  }
  const auto without = leave_one_out(n, [&](std::span<const double> w) { return model.fit_straight(w); });
  out.straight_jackknife = without
                               ? Result<CurveSpread>(spread_of(*out.straight, *without, options.confidence))
                               : Refusal{without.reason()};
  return out;
}

}  // namespace stats
