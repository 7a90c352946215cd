#pragma once
/// Smooth functions of a few variables and their minima.

#include <functional>
#include <span>
#include <vector>

namespace stats {

/// Value at x, its gradient written to the second span; infinite outside the domain (the gradient is then
/// not read).
using Objective = std::function<double(std::span<const double>, std::span<double>)>;

struct Minimum {
  std::vector<double> x;
  double value = 0;
  std::vector<double> hessian;  ///< row-major; from central differences of the gradient
  /// The Hessian is positive definite and Newton's last step was at most 1e-6; of minimise_near: another step
  /// would lower the value by less than 1e-10.
  bool converged = false;
};

/// A local minimum: BFGS (Nocedal and Wright 2006, algorithm 6.1) with a line search that asks for
/// sufficient decrease, then Newton steps. Variables should be of the order 1; `start` lies in the domain
/// (std::invalid_argument).
Minimum minimise(const Objective& objective, std::vector<double> start);

/// The same for one of many problems that are nearly alike: BFGS alone, begun with another's inverse Hessian
/// (row-major). No Hessian comes back.
Minimum minimise_near(const Objective& objective, std::vector<double> start,
                      std::vector<double> inverse_hessian);

}  // namespace stats
