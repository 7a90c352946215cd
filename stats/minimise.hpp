#pragma once
/// Local minimisation of smooth functions of a few variables.

#include <functional>
#include <span>
#include <vector>

namespace stats {

/// Returns the objective's value at x (first argument) and writes its gradient to the second. The value is
/// infinite outside the domain, where the gradient is not read.
using Objective = std::function<double(std::span<const double>, std::span<double>)>;

struct Minimum {
  std::vector<double> x;
  double value = 0;
  std::vector<double> hessian;  ///< row-major; from central differences of the gradient
  /// minimise(): the Hessian is positive definite and the last Newton step was at most 1e-6. minimise_near():
  /// another step would lower the value by less than 1e-10.
  bool converged = false;
};

/// Finds a local minimum: BFGS (Nocedal and Wright 2006, algorithm 6.1) with a line search for sufficient
/// decrease, then Newton steps. Variables should be of order 1. `start` must lie in the domain
/// (std::invalid_argument).
Minimum minimise(const Objective& objective, std::vector<double> start);

/// Minimises one of many similar problems by BFGS alone. `inverse_hessian` (row-major) is that of a similar
/// problem at its minimum. Returns no Hessian.
Minimum minimise_near(const Objective& objective, std::vector<double> start,
                      std::vector<double> inverse_hessian);

}  // namespace stats
