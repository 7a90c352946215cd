#pragma once
/// Times of day in another program's table.

#include <cstddef>
#include <string>

#include "libstudy/store/import/source_table.hpp"

namespace study {

/// The time in a field as UTC, "2026-01-31T12:00:00Z". Reads ISO 8601 ("2026-01-31T13:00:00.5+01:00", a space
/// or
/// "_" for the T) and PsychoPy's form ("2026-01-31_13h00.00.500"). utc_offset: of a time without one, such as
/// "+01:00"; empty: not known. base::Error at the row for any other text, a time without an offset if
/// `utc_offset` is empty, and a time in the future.
std::string utc_in(const SourceTable& table, const SourceTable::Row& row, std::size_t place,
                   const std::string& utc_offset);

}  // namespace study
