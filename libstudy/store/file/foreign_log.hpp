#pragma once
/// Checks that SQLite's log "<database>-wal" and rollback journal "<database>-journal" belong to the database
/// beside them. SQLite itself applies any valid log or journal, even of another database.
///
/// The first page of a vip-study database identifies it, and each Transaction that changes rows writes this
/// page (Connection::mark_commits()). The page contains the schema cookie and a change counter. The cookie is
/// a random number >= first_identity, chosen when the database was made or upgraded. The cookies of log and
/// file may differ by less than 10,000, because each schema change and each VACUUM increases the cookie by
/// one. The first change counter in the log must exceed that of the file by at most one; the last must not be
/// below it. The format: https://www.sqlite.org/fileformat2.html

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <optional>
#include <string>

namespace study {

/// The smallest schema cookie that is a random identity. A smaller cookie counts schema changes: the database
/// has no random identity yet.
inline constexpr std::int64_t first_identity = 1 << 16;

struct ForeignLog {
  std::filesystem::path file;
  std::string problem;
};

/// The log or journal beside the database that does not belong to it, with the reason; none if both belong to
/// it or do not exist. Changes no file. `header` returns the current first 100 bytes of the database; it is
/// called again for each new try, because another program may be writing.
std::optional<ForeignLog> foreign_log(const std::filesystem::path& database,
                                      const std::function<std::string()>& header);

/// base::Error if foreign_log() finds a log or journal of another database.
void refuse_foreign_log(const std::filesystem::path& database, const std::function<std::string()>& header);

/// base::Error if the database is missing or empty, but its log has commits. SQLite would delete this log
/// when it makes a database at the path.
void refuse_orphaned_log(const std::filesystem::path& database);

}  // namespace study
