#include "stats/inference/linear_fit.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>

#include "stats/inference/distributions.hpp"
#include "stats/inference/sample.hpp"

namespace stats {

namespace {

using Column = std::vector<Wide>;

Wide dot(const Column& a, const Column& b, std::size_t from) {
  Wide sum;
  for (std::size_t i = from; i < a.size(); ++i) sum += a[i] * b[i];
  return sum;
}

/// Householder reflection of `column` in the plane with the normal vector `mirror`. Only rows from `from` on
/// are read and changed.
void reflect(Column& column, const Column& mirror, Wide mirror_square, std::size_t from) {
  const Wide factor = Wide(2) * dot(column, mirror, from) / mirror_square;
  for (std::size_t i = from; i < column.size(); ++i) column[i] -= factor * mirror[i];
}

/// A column depends on the columns before it if its part orthogonal to them is less than this share of its
/// length. Smaller parts may be rounding of the columns' values.
constexpr double dependence = 1e-14;

/// QR decomposition by Householder: the columns become R, y becomes Q^T y. Returns false if a column is a
/// linear combination of earlier ones.
bool triangulate(std::vector<Column>& columns, Column& y) {
  for (std::size_t j = 0; j < columns.size(); ++j) {
    const double length = std::sqrt(dot(columns[j], columns[j], 0).value());
    const Wide below = dot(columns[j], columns[j], j);
    if (!(std::sqrt(below.value()) > dependence * length)) return false;
    Column mirror = columns[j];
    const Wide norm = sqrt(below);
    mirror[j] += mirror[j] < Wide(0) ? -norm : norm;
    const Wide square = dot(mirror, mirror, j);
    for (std::size_t k = j; k < columns.size(); ++k) reflect(columns[k], mirror, square, j);
    reflect(y, mirror, square, j);
  }
  return true;
}

/// R^-1, upper triangular, as columns.
std::vector<Column> inverse(const std::vector<Column>& r) {
  const auto p = r.size();
  std::vector<Column> out(p, Column(p));
  for (std::size_t j = 0; j < p; ++j) {
    for (std::size_t i = j + 1; i-- > 0;) {
      Wide sum = i == j ? 1 : 0;
      for (std::size_t k = i + 1; k <= j; ++k) sum -= r[k][i] * out[j][k];
      out[j][i] = sum / r[i][i];
    }
  }
  return out;
}

/// Fits columns scaled by 2^-exponent. `exponents` and `y_exponent` scale the results back to the data's
/// units.
Result<LinearFit> fit(std::vector<Column> columns, const std::vector<int>& exponents, Column y,
                      int y_exponent, bool intercept, std::size_t n_missing) {
  const auto n = y.size(), p = columns.size();
  if (n < p || p == 0) return Refusal{"fewer rows than coefficients"};
  const auto of_y = moments(y);
  const Wide total = intercept ? of_y.squares : dot(y, y, 0);
  if (!triangulate(columns, y)) return Refusal{"the columns depend on each other"};
  const auto inverted = inverse(columns);

  LinearFit out;
  out.n = n;
  out.n_missing = n_missing;
  out.df = static_cast<double>(n - p);
  const double rss = dot(y, y, p).value();
  out.rss = std::ldexp(rss, 2 * y_exponent);
  if (out.df > 0) out.residual_sd = std::ldexp(std::sqrt(rss / out.df), y_exponent);
  for (std::size_t i = 0; i < p; ++i) {
    Wide coefficient, square;
    for (std::size_t j = i; j < p; ++j) {
      coefficient += inverted[j][i] * y[j];
      square += inverted[j][i] * inverted[j][i];
    }
    const int back = y_exponent - exponents[i];
    out.coefficients.push_back(std::ldexp(coefficient.value(), back));
    if (out.df > 0) out.standard_errors.push_back(std::ldexp(std::sqrt(rss / out.df * square.value()), back));
  }
  const double slopes = static_cast<double>(p) - (intercept ? 1 : 0);
  if (!(total.high > 0)) return out;
  out.r2 = (Wide(1) - dot(y, y, p) / total).value();
  if (slopes > 0 && out.df > 0 && rss > 0) {
    out.f = (total - dot(y, y, p)).value() / slopes / (rss / out.df);
    out.f_p = fisher_upper(std::max(*out.f, 0.0), slopes, out.df);
  }
  return out;
}

struct Rows {
  std::vector<std::vector<double>> columns;
  std::vector<double> y;
  std::size_t n_missing = 0;
};

Result<Rows> complete(const std::vector<std::vector<double>>& columns, std::span<const double> y) {
  for (const auto& column : columns) {
    if (column.size() != y.size())
      throw std::invalid_argument(
          "fit_linear: a column and y differ in length; give one value for each row in every column");
  }
  Rows out;
  out.columns.resize(columns.size());
  for (std::size_t i = 0; i < y.size(); ++i) {
    const auto any = [&](auto test) {
      return test(y[i]) ||
             std::any_of(columns.begin(), columns.end(), [&](const auto& c) { return test(c[i]); });
    };
    if (any([](double v) { return std::isnan(v); })) {
      ++out.n_missing;
      continue;
    }
    if (any([](double v) { return std::isinf(v); })) return Refusal{"a value is infinite"};
    for (std::size_t j = 0; j < columns.size(); ++j) out.columns[j].push_back(columns[j][i]);
    out.y.push_back(y[i]);
  }
  return out;
}

}  // namespace

Result<LinearFit> fit_linear(const std::vector<std::vector<double>>& columns, std::span<const double> y,
                             bool intercept) {
  const auto rows = complete(columns, y);
  if (!rows) return Refusal{rows.reason()};
  std::vector<Column> design;
  std::vector<int> exponents;
  if (intercept) {
    design.emplace_back(rows->y.size(), Wide(1));
    exponents.push_back(0);
  }
  for (const auto& column : rows->columns) {
    exponents.push_back(common_exponent(column));
    design.push_back(scaled(column, exponents.back()));
  }
  const int y_exponent = common_exponent(rows->y);
  return fit(std::move(design), exponents, scaled(rows->y, y_exponent), y_exponent, intercept,
             rows->n_missing);
}

}  // namespace stats
