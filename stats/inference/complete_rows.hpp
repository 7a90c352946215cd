#pragma once
/// A table of participants by conditions, without participants who lack a value.

#include <span>
#include <string>
#include <vector>

namespace stats {

struct CompleteRows {
  std::vector<double> values{};  ///< n rows of k
  int n = 0, n_missing = 0, k = 0;
  std::string refusal{};  ///< fewer than two conditions or complete rows, or an infinite value; else empty

  std::span<const double> row(int i) const {
    return std::span(values).subspan(static_cast<std::size_t>(i) * static_cast<std::size_t>(k),
                                     static_cast<std::size_t>(k));
  }
};

/// std::invalid_argument when the values do not fill whole rows or k < 1.
CompleteRows complete_rows(std::span<const double> rows, int k);

}  // namespace stats
