#pragma once
/// Nodes of Gauss-Hermite quadrature for integrals over a normal effect.

#include <vector>

namespace stats {

/// sqrt(2) z and log(w exp(z^2) / sqrt(pi)), for the nodes z and their weights w: the integral of exp(g(u))
/// over u / sqrt(2 pi) is about scale * sum exp(log_weight + g(mode + scale * node)).
struct GaussHermite {
  std::vector<double> nodes, log_weights;
};

/// points >= 1 (std::invalid_argument).
GaussHermite gauss_hermite(int points);

}  // namespace stats
