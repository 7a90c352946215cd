#pragma once
/// Checks that the log "<database>-wal" and the journal "<database>-journal" beside a database belong to it.
/// SQLite does not check that: it applies any log or journal that is valid in itself.
///
/// Databases of this program identify themselves in the first page, which each commit rewrites. The schema
/// cookie is a random number (>= first_identity) chosen when the database was made or upgraded; the log's
/// change counter must continue the database's. The format: https://www.sqlite.org/fileformat2.html

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <optional>
#include <string>

namespace study {

/// Smaller cookies count schema changes: the database has no random identity yet.
inline constexpr std::int64_t first_identity = 1 << 16;

struct ForeignLog {
  std::filesystem::path file;
  std::string problem;
};

/// None: both belong to the database or do not exist. `header` returns the current first 100 bytes of the
/// database, since another program may be writing. Changes nothing.
std::optional<ForeignLog> foreign_log(const std::filesystem::path& database,
                                      const std::function<std::string()>& header);

/// base::Error if foreign_log() finds one.
void refuse_foreign_log(const std::filesystem::path& database, const std::function<std::string()>& header);

/// base::Error if the database is missing or empty but its log is not: SQLite would delete that log when it
/// makes a database there.
void refuse_orphaned_log(const std::filesystem::path& database);

}  // namespace study
