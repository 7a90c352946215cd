#pragma once
/// Local minimisation of smooth functions of a few variables.

#include <functional>
#include <span>
#include <vector>

namespace stats {

/// Returns the objective's value at x (first argument) and writes its gradient to the second. Outside the
/// objective's domain the value is infinite.
using Objective = std::function<double(std::span<const double>, std::span<double>)>;

struct Minimum {
  std::vector<double> x;
  double value = 0;
  std::vector<double> hessian;  ///< row-major; from central differences of the gradient
  /// minimise(): the Hessian is positive definite and no component of the last Newton step exceeded 1e-6.
  /// minimise_near(): to first order, another BFGS step would lower the value by less than 1e-10.
  bool converged = false;
};

/// Finds a local minimum: BFGS (Nocedal and Wright 2006, algorithm 6.1) with a backtracking line search, then
/// Newton steps. Variables should be of order 1. `start` must lie in the domain (std::invalid_argument).
Minimum minimise(const Objective& objective, std::vector<double> start);

/// Minimises one of many similar problems by BFGS alone. `inverse_hessian` (row-major) is the inverse Hessian
/// of a similar problem at its minimum. The result's `hessian` is empty. `start` must lie in the domain, and
/// `inverse_hessian` must fit its size (std::invalid_argument).
Minimum minimise_near(const Objective& objective, std::vector<double> start,
                      std::vector<double> inverse_hessian);

}  // namespace stats
