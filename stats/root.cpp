#include "stats/root.hpp"

#include <gsl/gsl_errno.h>
#include <gsl/gsl_roots.h>

#include <cmath>
#include <memory>
#include <new>
#include <stdexcept>

#include "stats/gsl_errors.hpp"

namespace stats {

double find_root(const std::function<double(double)>& f, double low, double high) {
  use_gsl_codes();
  const double at_low = f(low);
  const double at_high = f(high);
  if (at_low == 0) return low;
  if (at_high == 0) return high;
  if (!std::isfinite(at_low) || !std::isfinite(at_high) || (at_low > 0) == (at_high > 0))
    throw std::invalid_argument(
        "find_root: the function is not finite or has the same sign at both ends; give ends between which it "
        "changes sign");

  gsl_function wrapped;
  wrapped.function = [](double x, void* user) {
    return (*static_cast<const std::function<double(double)>*>(user))(x);
  };
  wrapped.params = const_cast<std::function<double(double)>*>(&f);
  const std::unique_ptr<gsl_root_fsolver, decltype(&gsl_root_fsolver_free)> solver(
      gsl_root_fsolver_alloc(gsl_root_fsolver_brent), &gsl_root_fsolver_free);
  if (!solver) throw std::bad_alloc();
  gsl_root_fsolver_set(solver.get(), &wrapped, low, high);
  for (int i = 0; i < 100; ++i) {
    if (gsl_root_fsolver_iterate(solver.get()) != GSL_SUCCESS) break;
    const int found = gsl_root_test_interval(gsl_root_fsolver_x_lower(solver.get()),
                                             gsl_root_fsolver_x_upper(solver.get()), 0, 1e-15);
    if (found == GSL_SUCCESS) break;
  }
  return gsl_root_fsolver_root(solver.get());
}

}  // namespace stats
