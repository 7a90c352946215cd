#include "libsim/levels/coarsen.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <numeric>
#include <stdexcept>

namespace sim {

namespace {

using Place = std::array<float, 3>;

Place place_of(const ParticleState& p) { return {p.x_m, p.y_m, p.z_m}; }

class Coarsening {
 public:
  Coarsening(std::span<const ParticleState> finest, std::span<const std::uint8_t> targets)
      : finest_(finest), targets_(targets), order_(finest.size()) {
    std::iota(order_.begin(), order_.end(), std::size_t{0});
  }

  std::vector<ParticleState> run() {
    if (!order_.empty()) visit(order_);
    std::sort(out_.begin(), out_.end(), [](const auto& a, const auto& b) { return a.id < b.id; });
    return std::move(out_);
  }

 private:
  using Node = std::span<std::size_t>;

  void visit(Node node) {
    if (node.size() <= 8) {
      const int level = std::countr_zero(node.size());
      const bool all =
          std::all_of(node.begin(), node.end(), [&](std::size_t i) { return targets_[i] >= level; });
      if (all) {
        out_.push_back(merged(node, level));
        return;
      }
    }
    // A node of more than eight particles is divided at a multiple of eight, so that every leaf has exactly
    // eight.
    const std::size_t unit = node.size() > 8 ? 8 : 1;
    const std::size_t half = (node.size() / unit + 1) / 2 * unit;
    split(node, half);
    visit(node.first(half));
    visit(node.subspan(half));
  }

  /// Moves the `half` particles with the lowest coordinates along the node's longest axis to its front.
  void split(Node node, std::size_t half) const {
    const std::size_t axis = longest_axis(node);
    std::nth_element(node.begin(), node.begin() + static_cast<std::ptrdiff_t>(half), node.end(),
                     [&](std::size_t a, std::size_t b) {
                       const float at_a = place_of(finest_[a])[axis];
                       const float at_b = place_of(finest_[b])[axis];
                       return at_a != at_b ? at_a < at_b : finest_[a].id < finest_[b].id;
                     });
  }

  std::size_t longest_axis(Node node) const {
    Place low = place_of(finest_[node[0]]);
    Place high = low;
    for (const std::size_t i : node) {
      const Place at = place_of(finest_[i]);
      for (std::size_t k = 0; k < 3; ++k) {
        low[k] = std::min(low[k], at[k]);
        high[k] = std::max(high[k], at[k]);
      }
    }
    std::size_t longest = 0;
    for (std::size_t k = 1; k < 3; ++k) {
      if (high[k] - low[k] > high[longest] - low[longest]) longest = k;
    }
    return longest;
  }

  /// Merges a node's particles. Their masses are equal, so the mass-weighted mean is the plain mean. Sums
  /// follow the order of the ids, so that the input's order does not change the rounding.
  ParticleState merged(Node node, int level) const {
    std::sort(node.begin(), node.end(),
              [&](std::size_t a, std::size_t b) { return finest_[a].id < finest_[b].id; });
    std::array<double, 6> sum{};
    for (const std::size_t i : node) {
      const auto& p = finest_[i];
      const std::array<float, 6> values{p.x_m, p.y_m, p.z_m, p.vx_m_s, p.vy_m_s, p.vz_m_s};
      for (std::size_t k = 0; k < 6; ++k) sum[k] += static_cast<double>(values[k]);
    }
    const auto mean = [&](std::size_t k) {
      return static_cast<float>(sum[k] / static_cast<double>(node.size()));
    };
    return {finest_[node[0]].id, level, mean(0), mean(1), mean(2), mean(3), mean(4), mean(5)};
  }

  std::span<const ParticleState> finest_;
  std::span<const std::uint8_t> targets_;
  std::vector<std::size_t> order_;
  std::vector<ParticleState> out_;
};

void check(std::span<const ParticleState> finest, std::span<const std::uint8_t> targets) {
  if (finest.size() % 8)
    throw std::invalid_argument("sim::coarsen: the particles are no multiple of eight; give 8, 16, 24, ...");
  if (targets.size() != finest.size())
    throw std::invalid_argument(
        "sim::coarsen: there are not as many targets as particles; give one for each");
  for (std::size_t i = 0; i < finest.size(); ++i) {
    const auto& p = finest[i];
    if (p.level != 0)
      throw std::invalid_argument("sim::coarsen: a particle is not of level 0; give only finest particles");
    if (targets[i] > 3)
      throw std::invalid_argument("sim::coarsen: a target level is above 3; use levels 0 to 3");
    if (!std::isfinite(p.x_m) || !std::isfinite(p.y_m) || !std::isfinite(p.z_m))
      throw std::invalid_argument("sim::coarsen: a position is not finite; give finite positions");
  }
}

}  // namespace

std::vector<ParticleState> coarsen(std::span<const ParticleState> finest,
                                   std::span<const std::uint8_t> targets) {
  check(finest, targets);
  return Coarsening(finest, targets).run();
}

}  // namespace sim
