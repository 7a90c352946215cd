#include "stats/inference/complete_rows.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>

namespace stats {

CompleteRows complete_rows(std::span<const double> rows, int k) {
  if (k < 1 || rows.size() % static_cast<std::size_t>(k) != 0)
    throw std::invalid_argument("values must fill whole rows of at least one");
  CompleteRows out{.k = k};
  const auto width = static_cast<std::size_t>(k);
  for (std::size_t first = 0; first < rows.size(); first += width) {
    const auto row = rows.subspan(first, width);
    if (std::any_of(row.begin(), row.end(), [](double v) { return std::isnan(v); })) {
      ++out.n_missing;
      continue;
    }
    if (std::any_of(row.begin(), row.end(), [](double v) { return std::isinf(v); }))
      out.refusal = "an infinite value";
    out.values.insert(out.values.end(), row.begin(), row.end());
    ++out.n;
  }
  if (k < 2)
    out.refusal = "fewer than two conditions";
  else if (out.n < 2)
    out.refusal = "fewer than two participants with all conditions";
  return out;
}

}  // namespace stats
