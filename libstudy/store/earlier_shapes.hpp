#pragma once
/// Part of salvage(): rows that an earlier schema wrote, read off the pages of a damaged database.

#include <optional>
#include <vector>

#include "libstudy/store/page_scan.hpp"

namespace study::salvaging {

/// A table as an earlier schema had it.
struct EarlierShape {
  Shape shape;
  std::size_t now = 0;                             ///< index of the table's present shape
  std::vector<std::optional<std::size_t>> source;  ///< of each present column: the column it is taken from
};

/// Of schemas 2 and newer, those tables that have changed since. A column is taken where name, type and
/// NOT NULL are as they were; one that may be NULL since then was not measured before.
std::vector<EarlierShape> earlier_shapes(const std::vector<Shape>& now);

/// The row as the present schema holds it.
Values as_now(const EarlierShape& earlier, const Values& row);

}  // namespace study::salvaging
