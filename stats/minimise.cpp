#include "stats/minimise.hpp"

#include <algorithm>
#include <cmath>
#include <optional>
#include <stdexcept>

#include "stats/cholesky.hpp"

namespace stats {

namespace {

using Vector = std::vector<double>;

double dot(std::span<const double> a, std::span<const double> b) {
  double sum = 0;
  for (std::size_t i = 0; i < a.size(); ++i) sum += a[i] * b[i];
  return sum;
}

double largest(std::span<const double> a) {
  double out = 0;
  for (const double v : a) out = std::max(out, std::abs(v));
  return out;
}

struct Point {
  Vector x, gradient;
  double value = 0;
};

class Descent {
 public:
  Descent(const Objective& objective, Vector start) : f_(objective), n_(start.size()) {
    at_.x = std::move(start);
    at_.gradient.resize(n_);
    at_.value = f_(at_.x, at_.gradient);
    if (!std::isfinite(at_.value))
      throw std::invalid_argument(
          "minimise: the objective is not finite at `start`; start within its domain");
  }

  /// Takes BFGS steps from the approximation `inverse` of the inverse Hessian (empty: a scaled identity)
  /// until the next full step would lower the value by less than `least` to first order. Returns false if the
  /// line search fails, or after 500 steps.
  bool bfgs(Vector inverse, double least);
  const Point& at() const { return at_; }
  Minimum newton();

 private:
  /// Line search: the first of the step lengths 1, 1/2, 1/4 ... along `direction` that lowers the value by at
  /// least `decrease` * length * |slope|, where `slope` is the value's derivative along `direction`. Returns
  /// nothing if no length above 1e-12 does.
  std::optional<Point> step(const Vector& direction, double slope, double decrease) const;
  Vector hessian() const;
  void update_inverse(Vector& inverse, const Vector& s, const Vector& y) const;

  const Objective& f_;
  std::size_t n_;
  Point at_;
};

std::optional<Point> Descent::step(const Vector& direction, double slope, double decrease) const {
  Point next;
  next.x.resize(n_);
  next.gradient.resize(n_);
  for (double length = 1; length > 1e-12; length /= 2) {
    for (std::size_t i = 0; i < n_; ++i) next.x[i] = at_.x[i] + length * direction[i];
    next.value = f_(next.x, next.gradient);
    if (next.value <= at_.value + decrease * length * slope) return next;
  }
  return std::nullopt;
}

/// BFGS update of the inverse Hessian (Nocedal and Wright 2006, Eq. 6.17). s is the step and y the change of
/// the gradient. The update is skipped unless the curvature s^T y exceeds 1e-10 |s| |y|.
void Descent::update_inverse(Vector& inverse, const Vector& s, const Vector& y) const {
  const double curvature = dot(s, y);
  if (!(curvature > 1e-10 * std::sqrt(dot(s, s) * dot(y, y)))) return;
  Vector hy(n_);
  for (std::size_t i = 0; i < n_; ++i) hy[i] = dot({&inverse[i * n_], n_}, y);
  const double scale = (1 + dot(y, hy) / curvature) / curvature;
  for (std::size_t i = 0; i < n_; ++i) {
    for (std::size_t j = 0; j < n_; ++j) {
      inverse[i * n_ + j] += scale * s[i] * s[j] - (hy[i] * s[j] + s[i] * hy[j]) / curvature;
    }
  }
}

bool Descent::bfgs(Vector inverse, double least) {
  Vector direction(n_), s(n_), y(n_);
  const auto restart = [&] {
    inverse.assign(n_ * n_, 0.0);
    for (std::size_t i = 0; i < n_; ++i) inverse[i * n_ + i] = 1 / std::max(1.0, largest(at_.gradient));
  };
  if (inverse.empty()) restart();
  for (int iteration = 0; iteration < 500; ++iteration) {
    for (std::size_t i = 0; i < n_; ++i) direction[i] = -dot({&inverse[i * n_], n_}, at_.gradient);
    const double slope = dot(direction, at_.gradient);
    if (slope > 0) {
      restart();
      continue;
    }
    if (-slope < least) return true;
    const auto next = step(direction, slope, 1e-4);
    if (!next) return false;
    for (std::size_t i = 0; i < n_; ++i) {
      s[i] = next->x[i] - at_.x[i];
      y[i] = next->gradient[i] - at_.gradient[i];
    }
    at_ = *next;
    update_inverse(inverse, s, y);
  }
  return false;
}

Vector Descent::hessian() const {
  Vector out(n_ * n_), x = at_.x, above(n_), below(n_);
  for (std::size_t i = 0; i < n_; ++i) {
    const double h = 1e-5 * std::max(1.0, std::abs(x[i]));
    x[i] = at_.x[i] + h;
    f_(x, above);
    x[i] = at_.x[i] - h;
    f_(x, below);
    x[i] = at_.x[i];
    for (std::size_t j = 0; j < n_; ++j) out[i * n_ + j] = (above[j] - below[j]) / (2 * h);
  }
  for (std::size_t i = 0; i < n_; ++i) {
    for (std::size_t j = 0; j < i; ++j) {
      out[i * n_ + j] = out[j * n_ + i] = (out[i * n_ + j] + out[j * n_ + i]) / 2;
    }
  }
  return out;
}

Minimum Descent::newton() {
  Minimum out;
  for (int iteration = 0; iteration < 12 && !out.converged; ++iteration) {
    out.hessian = hessian();
    const auto factor = Cholesky::of(out.hessian);
    if (!factor) break;
    Vector direction = factor->solve(at_.gradient);
    for (double& v : direction) v = -v;
    const double length = largest(direction);
    out.converged = length <= 1e-6;
    const auto next = step(direction, dot(direction, at_.gradient), 0);
    if (next) at_ = *next;
    if (!next) break;
  }
  out.x = at_.x;
  out.value = at_.value;
  return out;
}

}  // namespace

Minimum minimise(const Objective& objective, std::vector<double> start) {
  Descent descent(objective, std::move(start));
  descent.bfgs({}, 1e-9);
  return descent.newton();
}

Minimum minimise_near(const Objective& objective, std::vector<double> start,
                      std::vector<double> inverse_hessian) {
  if (inverse_hessian.size() != start.size() * start.size())
    throw std::invalid_argument(
        "minimise_near: `inverse_hessian` does not fit `start`; give n x n elements for n variables");
  Descent descent(objective, std::move(start));
  const bool converged = descent.bfgs(std::move(inverse_hessian), 1e-10);
  return {descent.at().x, descent.at().value, {}, converged};
}

}  // namespace stats
