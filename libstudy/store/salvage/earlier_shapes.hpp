#pragma once
/// Reads rows of an earlier schema from the pages of a damaged database, for salvage().

#include <optional>
#include <vector>

#include "libstudy/store/salvage/page_scan.hpp"

namespace study::salvaging {

/// A table in an earlier schema.
struct EarlierShape {
  Shape shape;
  std::size_t now = 0;                             ///< index of the table's current shape
  std::vector<std::optional<std::size_t>> source;  ///< by current column: earlier column copied; none: NULL
};

/// Tables of schemas 2 and newer that have changed since. A column is copied if name, type and NOT NULL are
/// unchanged; a newer nullable column becomes NULL (not measured).
std::vector<EarlierShape> earlier_shapes(const std::vector<Shape>& now);

/// The row in the current schema.
Values as_now(const EarlierShape& earlier, const Values& row);

}  // namespace study::salvaging
