#include "stats/ptpe/rating_surface.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>

#include "stats/ptpe/term_sums.hpp"
#include "stats/quantiles.hpp"

namespace stats {

std::map<int, std::pair<double, double>> sessions_of(std::span<const PilotRating> ratings) {
  std::map<int, std::pair<double, double>> out;
  for (const auto& rating : ratings) {
    const double at = rating.position;
    auto& [first, last] = out.try_emplace(rating.participant, at, at).first->second;
    first = std::min(first, at);
    last = std::max(last, at);
  }
  return out;
}

double place_of(const PilotRating& rating, const std::pair<double, double>& session) {
  const double length = session.second - session.first;
  return length > 0 ? (rating.position - session.first) / length - 0.5 : 0;
}

namespace {

/// A surface of scores over the settings, with a mean for each participant: its terms are x, e, x e, x^2, e^2
/// and the place in the session, where x is log2 of the mean frame rate about its mean and e the standard
/// deviation by the largest one.
constexpr std::size_t surface_terms = 6, place_term = 5;
using SurfaceRow = std::array<double, surface_terms>;
using SurfaceSums = TermSums<surface_terms>;

std::vector<SurfaceRow> surface_rows(std::span<const PilotRating> ratings) {
  const auto sessions = sessions_of(ratings);
  double x_mean = 0, e_most = 0;
  for (const auto& rating : ratings) {
    x_mean += std::log2(rating.mu) / static_cast<double>(ratings.size());
    e_most = std::max(e_most, rating.delta);
  }
  std::vector<SurfaceRow> rows;
  for (const auto& rating : ratings) {
    const double x = std::log2(rating.mu) - x_mean, e = e_most > 0 ? rating.delta / e_most : 0;
    rows.push_back({x, e, x * e, x * x, e * e, place_of(rating, sessions.at(rating.participant))});
  }
  return rows;
}

/// Sums of the rows and scores about each participant's weighted means, by participant.
std::map<int, SurfaceSums> surface_sums(std::span<const PilotRating> ratings,
                                        const std::vector<SurfaceRow>& rows,
                                        const std::vector<double>& weights) {
  struct Means {
    SurfaceRow row{};
    double score = 0, weight = 0;
  };
  std::map<int, Means> means;
  for (std::size_t i = 0; i < rows.size(); ++i) {
    Means& own = means[ratings[i].participant];
    for (std::size_t t = 0; t < surface_terms; ++t) own.row[t] += weights[i] * rows[i][t];
    own.score += weights[i] * ratings[i].score;
    own.weight += weights[i];
  }
  std::map<int, SurfaceSums> out;
  for (std::size_t i = 0; i < rows.size(); ++i) {
    const Means& own = means[ratings[i].participant];
    const double root = std::sqrt(weights[i]);
    SurfaceRow row{};
    for (std::size_t t = 0; t < surface_terms; ++t) row[t] = root * (rows[i][t] - own.row[t] / own.weight);
    out[ratings[i].participant].add(row, root * (ratings[i].score - own.score / own.weight));
  }
  return out;
}

/// The surface's coefficients by least squares. A small ridge makes terms that do not vary harmless.
SurfaceRow surface_of(SurfaceSums sums) {
  constexpr double ridge = 1e-3;
  for (std::size_t t = 0; t < surface_terms; ++t) sums.gram[t * (surface_terms + 1)] += ridge;
  return solve_positive<surface_terms>(sums.gram, sums.moment).value_or(SurfaceRow{});
}

SurfaceSums total_of(const std::map<int, SurfaceSums>& people) {
  SurfaceSums all;
  for (const auto& [person, sums] : people) all.add(sums, 1);
  return all;
}

}  // namespace

std::vector<double> surface_scores(std::span<const PilotRating> ratings) {
  constexpr int rounds = 20;
  constexpr double huber = 1.5;  // in standard deviations
  const auto rows = surface_rows(ratings);
  std::vector<double> weights(rows.size(), 1), out(rows.size()), rest(rows.size()), far(rows.size());
  for (int round = 0; round < rounds; ++round) {
    const SurfaceRow at = surface_of(total_of(surface_sums(ratings, rows, weights)));
    std::map<int, std::vector<double>> own;
    for (std::size_t i = 0; i < rows.size(); ++i) {
      out[i] = 0;
      for (std::size_t t = 0; t < place_term; ++t) out[i] += at[t] * rows[i][t];
      rest[i] = ratings[i].score - out[i] - at[place_term] * rows[i][place_term];
      own[ratings[i].participant].push_back(rest[i]);
    }
    std::map<int, double> middle;
    for (const auto& [person, all] : own) middle[person] = median_of(all);
    for (std::size_t i = 0; i < rows.size(); ++i) far[i] = std::abs(rest[i] - middle[ratings[i].participant]);
    const double reach = huber * 1.4826 * median_of(far);  // of a normal distribution
    for (std::size_t i = 0; i < rows.size(); ++i) weights[i] = far[i] > reach ? reach / far[i] : 1;
  }
  return out;
}

std::vector<double> surface_changes(std::span<const PilotRating> ratings) {
  const auto rows = surface_rows(ratings);
  const auto people = surface_sums(ratings, rows, std::vector<double>(rows.size(), 1));
  const SurfaceSums all = total_of(people);
  const double whole = surface_of(all)[place_term], n = static_cast<double>(people.size());
  std::vector<double> out;
  for (const auto& [person, sums] : people) {
    SurfaceSums others = all;
    others.add(sums, -1);
    out.push_back(n * whole - (n - 1) * surface_of(others)[place_term]);
  }
  return out;
}

}  // namespace stats
