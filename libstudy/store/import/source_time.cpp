#include "libstudy/store/import/source_time.hpp"

#include <cstdint>
#include <optional>

#include "libstudy/store/import/cell_match.hpp"
#include "stats/base/file.hpp"
#include "stats/base/pattern.hpp"
#include "stats/base/text.hpp"
#include "stats/base/utc.hpp"

namespace study {

namespace {

/// Seconds of an offset such as "+02:00", "-0500" or "Z".
std::int64_t seconds_of_offset(const std::string& offset) {
  if (offset == "Z") return 0;
  const std::string minutes = offset.substr(offset.size() - 2);
  const std::int64_t seconds = 3600 * base::parse_number<int>(offset.substr(1, 2)).value_or(0) +
                               60 * base::parse_number<int>(minutes).value_or(0);
  return offset.front() == '-' ? -seconds : seconds;
}

}  // namespace

std::string utc_in(const SourceTable& table, const SourceTable::Row& row, std::size_t place,
                   const std::string& utc_offset) {
  static const base::Pattern time(
      "([0-9]{4}-[0-9]{2}-[0-9]{2})[T _]([0-9]{2})[:h]([0-9]{2})[:.]([0-9]{2})([.][0-9]+)? ?"
      "(Z|[+-][0-9]{2}:?[0-9]{2})?");
  const auto found = time.match(row.fields[place]);
  std::optional<std::int64_t> seconds;
  if (found)
    seconds =
        base::seconds_of_utc((*found)[1] + "T" + (*found)[2] + ":" + (*found)[3] + ":" + (*found)[4] + "Z");
  if (!seconds)
    fail_at_field(table, row, place, "is no time of day that can be read",
                  "write it as 2026-01-31T13:00:00+01:00, or remove the column from the mapping");
  const std::string offset = (*found)[6].empty() ? utc_offset : (*found)[6];
  if (offset.empty())
    fail_at_field(
        table, row, place, "has no offset from UTC",
        "write utc_offset = \"+01:00\", or the offset that the clock had, at the top of the mapping");
  const std::string utc = base::utc_of_seconds(*seconds - seconds_of_offset(offset));
  if (utc > base::utc_now())
    fail_at_field(table, row, place, "lies in the future", "correct the time, or utc_offset in the mapping");
  return utc;
}

}  // namespace study
