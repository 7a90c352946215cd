#pragma once
/// Whether the log "<database>-wal" and the journal "<database>-journal" that stand beside a database are its
/// own. SQLite knows no such question: it takes whatever is sound by itself into the database.
///
/// Databases of this program answer it in the first page, which each of their commits writes again. The
/// schema cookie is a number that a database was given by chance when it was made (`identity_at`); the change
/// counter goes on where the database stands. The format: https://www.sqlite.org/fileformat2.html

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <optional>
#include <string>

namespace study {

/// Cookies below it count the changes of a schema: the database was given none by chance yet.
inline constexpr std::int64_t first_identity = 1 << 16;

struct ForeignLog {
  std::filesystem::path file;
  std::string problem;
};

/// None: they are the database's own, or there are none. `header` gives the first 100 bytes of the database
/// as they are at that time: another program may be writing. Nothing is changed.
std::optional<ForeignLog> foreign_log(const std::filesystem::path& database,
                                      const std::function<std::string()>& header);

/// base::Error where there is a foreign one.
void refuse_foreign_log(const std::filesystem::path& database, const std::function<std::string()>& header);

/// base::Error where no database, or an empty one, stands beside a log that holds something: SQLite would
/// delete that when it makes a database there.
void refuse_orphaned_log(const std::filesystem::path& database);

}  // namespace study
