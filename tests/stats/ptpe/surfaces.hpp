#pragma once
/// Simulated populations of raters, some outside every estimator's model. By brute force: the contour, which
/// is the curve of frame rates at which the population's mean score is `level`.

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <random>
#include <string>
#include <vector>

#include "stats/ptpe/pilot.hpp"
#include "stats/quantiles.hpp"
#include "stats/root.hpp"

namespace surfaces {

inline constexpr double level = 4;
inline const std::vector<double> rates{10, 20, 30, 40, 50}, deviations{0, 5, 10, 15, 20};

/// How a person differs from the population: three standard normal numbers.
using Person = std::array<double, 3>;

struct Population {
  std::string name;
  /// Score before noise and rounding.
  std::function<double(double mu, double delta, const Person&)> latent;
  double noise = 1;
  double lapses = 0;  ///< share of answers drawn uniformly from the seven
};

inline double exponential(double a, double b, double delta) { return a * std::exp(b * delta); }

/// A threshold of the mean frame rate as a function of its standard deviation.
using Threshold = std::function<double(double delta)>;

/// The parametric observer (libstudy/observer/ptpe_observer.hpp) with any threshold.
inline Population with_threshold(const std::string& name, const Threshold& threshold) {
  return {name, [=](double mu, double delta, const Person& z) {
            return level + 0.14 * (mu - threshold(delta)) + 0.5 * z[0];
          }};
}

inline Population parametric(double a, double b) {
  return with_threshold("parametric", [=](double delta) { return exponential(a, b, delta); });
}

/// An observer whose scores rise with the logarithm of the frame rate.
inline Population logarithmic(double a, double b) {
  return {"logarithmic", [=](double mu, double delta, const Person& z) {
            return level + 2.4 * std::log2(mu / exponential(a, b, delta)) + 0.5 * z[0];
          }};
}

/// Thresholds that are not exponential: one that levels off, one that begins to grow at 10, a straight line.
inline const Threshold saturating = [](double delta) { return 24 + 14 * (1 - std::exp(-delta / 5)); };
inline const Threshold hinged = [](double delta) { return 24 + 1.2 * std::max(0.0, delta - 10); };
inline const Threshold linear = [](double delta) { return 24 + 0.6 * delta; };

/// Populations outside every estimator's model, most of them with a threshold near 23.68 exp(0.02 delta).
inline std::vector<Population> strange() {
  constexpr double a = 23.68, b = 0.02;
  const auto tau = [](double mu, double delta) { return mu - exponential(a, b, delta); };
  auto lapsing = parametric(a, b);
  lapsing.name = "lapses in 10 %";
  lapsing.lapses = 0.1;
  return {
      {"contour curved",
       [](double mu, double delta, const Person& z) {
         return level + 0.14 * (mu - 20 - 0.04 * delta * delta) + 0.5 * z[0];
       }},
      {"tanh", [=](double mu, double delta,
                   const Person& z) { return level + 2.6 * std::tanh(0.09 * tau(mu, delta)) + 0.5 * z[0]; }},
      {"cubic",
       [=](double mu, double delta, const Person& z) {
         const double t = tau(mu, delta);
         return level + 0.06 * t + 0.00025 * t * t * t + 0.5 * z[0];
       }},
      {"longest freeze",
       [](double mu, double delta, const Person& z) {
         return level + 2.2 * std::log2(std::max(4.0, mu - 0.8 * delta) / 20) + 0.5 * z[0];
       }},
      {"personal use of the scale",
       [=](double mu, double delta, const Person& z) {
         return level + 0.4 + std::exp(0.4 * z[1]) * 0.14 * tau(mu, delta) + 0.8 * z[0] + 0.3 * z[1];
       }},
      {"personal thresholds",
       [](double mu, double delta, const Person& z) {
         return level + 0.14 * (mu - exponential(a * std::exp(0.25 * z[1]), b + 0.008 * z[2], delta)) +
                0.5 * z[0];
       }},
      lapsing};
}

inline std::vector<stats::PilotRating> pilot(const Population& population, int participants,
                                             std::uint64_t seed) {
  std::mt19937_64 engine(seed);
  std::normal_distribution<double> normal;
  std::uniform_real_distribution<double> uniform;
  std::vector<stats::PilotRating> ratings;
  for (int p = 0; p < participants; ++p) {
    const Person person{normal(engine), normal(engine), normal(engine)};
    for (const double mu : rates) {
      for (const double delta : deviations) {
        if (delta >= mu) continue;
        double x = population.latent(mu, delta, person) + population.noise * normal(engine);
        if (uniform(engine) < population.lapses) x = 0.5 + 7 * uniform(engine);
        ratings.push_back({p, mu, delta, mu, mu, delta, std::clamp(std::round(x), 1.0, 7.0)});
      }
    }
  }
  return ratings;
}

/// Mean score of the population at one setting: over people by a Halton sequence, over their noise exactly.
inline double mean_score(const Population& population, double mu, double delta) {
  constexpr int people = 512;
  const auto radical_inverse = [](int i, int base) {
    double out = 0, digit = 1.0 / base;
    for (; i > 0; i /= base, digit /= base) out += digit * (i % base);
    return out;
  };
  double sum = 0;
  for (int i = 0; i < people; ++i) {
    // Pairs of opposite normals, so that symmetric populations stay symmetric.
    const double sign = i % 2 == 0 ? 1 : -1;
    Person z;
    for (std::size_t k = 0; k < z.size(); ++k)
      z[k] = sign * stats::normal_quantile(radical_inverse(i / 2 + 1, std::array{2, 3, 5}[k]));
    const double x = population.latent(mu, delta, z);
    double score = 1;
    for (int j = 1; j <= 6; ++j) score += stats::normal_probability((x - j - 0.5) / population.noise);
    sum += (1 - population.lapses) * score + population.lapses * 4;
  }
  return sum / people;
}

/// The mean frame rate at which the population's mean score is `level`.
inline double mean_threshold(const Population& population, double delta) {
  return stats::find_root([&](double at) { return mean_score(population, at, delta) - level; }, 2, 200);
}

/// The contour of the population's mean score at the pilot's standard deviations. Also the exponential a
/// exp(b delta) nearest to it by least squares of log mu, over those standard deviations at which the contour
/// lies within the pilot's frame rates.
struct Truth {
  std::vector<double> delta, mu;
  double a = 0, b = 0;
};

inline Truth truth_of(const Population& population) {
  Truth out;
  double n = 0, x = 0, y = 0, xx = 0, xy = 0;
  for (const double delta : deviations) {
    const double mu = mean_threshold(population, delta);
    const double lowest =
        *std::find_if(rates.begin(), rates.end(), [&](double rate) { return rate > delta; });
    if (mu < lowest / stats::reach_margin || mu > rates.back() * stats::reach_margin) continue;
    out.delta.push_back(delta);
    out.mu.push_back(mu);
    n += 1;
    x += delta;
    y += std::log(mu);
    xx += delta * delta;
    xy += delta * std::log(mu);
  }
  out.b = n > 1 ? (n * xy - x * y) / (n * xx - x * x) : 0;
  out.a = n > 0 ? std::exp((y - out.b * x) / n) : 0;
  return out;
}

}  // namespace surfaces
