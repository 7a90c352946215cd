#pragma once
/// A pilot answered by the parametric observer's model (libstudy/observer/ptpe_observer.hpp), which stats
/// cannot include: x = 4 + slope (mu - a exp(b delta)) + participant + noise, rounded to the nearest of 1 to
/// 7.

#include <algorithm>
#include <cmath>
#include <ostream>
#include <random>
#include <vector>

#include "stats/ptpe/pilot.hpp"

namespace simulated {

struct Truth {
  double a = 24, b = 0.02;
  double slope = 0.14, noise = 1, participant_sd = 0.5;
};
inline void PrintTo(const Truth& truth, std::ostream* out) {
  *out << "a = " << truth.a << ", b = " << truth.b;
}

/// The paper's 21 settings, each rated once by each participant. The realised moments are the nominal ones.
inline std::vector<stats::PilotRating> pilot(const Truth& truth, int participants, std::uint64_t seed) {
  std::mt19937_64 engine(seed);
  std::normal_distribution<double> normal;
  std::vector<stats::PilotRating> ratings;
  for (int p = 0; p < participants; ++p) {
    const double person = truth.participant_sd * normal(engine);
    for (const double mu : {10.0, 20.0, 30.0, 40.0, 50.0}) {
      for (const double delta : {0.0, 5.0, 10.0, 15.0, 20.0}) {
        if (delta >= mu) continue;
        const double tau = mu - truth.a * std::exp(truth.b * delta);
        const double x = 4 + truth.slope * tau + person + truth.noise * normal(engine);
        ratings.push_back({p, mu, delta, mu, mu, delta, std::clamp(std::round(x), 1.0, 7.0)});
      }
    }
  }
  return ratings;
}

}  // namespace simulated
