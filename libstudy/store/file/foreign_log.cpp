#include "libstudy/store/file/foreign_log.hpp"

#include <chrono>
#include <string_view>
#include <thread>
#include <vector>

#include "libstudy/store/file/database.hpp"
#include "libstudy/store/file/page_file.hpp"
#include "stats/base/error.hpp"

namespace study {

namespace fs = std::filesystem;
using salvaging::application_at;
using salvaging::big_endian;
using salvaging::File;
using salvaging::Log;
using salvaging::u32;
using salvaging::version_at;

namespace {

// Offsets of fields in the database header.
constexpr std::size_t page_bytes_at = 16, format_at = 18, counter_at = 24, cookie_at = 40;
constexpr char format_of_logs = 2;
/// First schema version of the programs that write the first page in each commit.
constexpr std::uint32_t first_marked_version = 7;
/// Schema cookies that differ by less than this number belong to the same database. A cookie increases by one
/// with each change of the schema and each VACUUM.
constexpr std::int64_t most_changes = 10'000;
/// Largest accepted number of commits in a log that does not contain the first page. A commit outside a
/// Transaction, or of another program, writes the first page only if the number of pages or of free pages
/// changes.
constexpr std::size_t most_unmarked = 8;
constexpr int tries = 5;
constexpr std::chrono::milliseconds between_tries{20};

std::size_t page_bytes(std::string_view header) {
  const std::size_t bytes = big_endian(header.substr(page_bytes_at, 2));
  return bytes == 1 ? 65536 : bytes;
}

bool is_ours(std::string_view header) {
  return header.size() == salvaging::header_bytes && header.starts_with(salvaging::database_magic) &&
         u32(header, application_at) == database_application_id;
}

bool same_identity(std::string_view one, std::string_view other) {
  const std::int64_t a = u32(one, cookie_at), b = u32(other, cookie_at);
  return a - b < most_changes && b - a < most_changes;
}

bool has_identity(std::string_view header) { return u32(header, cookie_at) >= first_identity; }

/// The change counter in header `other` minus that in header `counter`, modulo 2^32 as a signed number.
std::int32_t behind(std::string_view counter, std::string_view other) {
  return static_cast<std::int32_t>(u32(other, counter_at) - u32(counter, counter_at));
}

std::string problem_of_log(const Log& log, std::string_view header) {
  if (log.is_empty()) return {};
  if (log.page_bytes() != page_bytes(header)) return "is of a database with another page size";
  const std::vector<std::string> heads = log.heads();
  if (heads.empty()) {
    return u32(header, version_at) >= first_marked_version && log.commits() > most_unmarked
               ? "does not name the database that it belongs to"
               : "";
  }
  for (const std::string& head : heads) {
    if (!is_ours(head)) return "is not of a database of vip-study";
    if (has_identity(header) && has_identity(head) && !same_identity(head, header))
      return "is of another database";
  }
  // An upgrade gives an older database its random cookie, and the log may also contain commits from before
  // the upgrade. So only the last version of the first page in the log must have a random cookie.
  if (has_identity(header) && !has_identity(heads.back())) return "is of another database";
  if (behind(header, heads.front()) > 1) return "is of a later state of the database than the file";
  if (behind(heads.back(), header) > 0) return "is of an earlier state of the database than the file";
  return {};
}

/// The database header in the first page as the journal recorded the page; empty if the journal's first
/// segment lacks the page.
std::string first_page_of(const File& journal, std::string_view head, std::size_t bytes) {
  const std::size_t record = 4 + bytes + 4;
  for (std::size_t at = u32(head, 20); at + record <= journal.size(); at += record) {
    const std::string page = journal.read(at, 4 + salvaging::header_bytes);
    if (u32(page, 0) == 1) return page.substr(4);
    if (u32(page, 0) == 0) break;
  }
  return {};
}

std::string problem_of_journal(const fs::path& path, std::string_view header) {
  const File journal(path);
  const std::string head = journal.read(0, 28);
  // A journal that ends with rollback_magic names a super-journal, a further file that SQLite would read and
  // possibly delete.
  if (journal.size() >= 16 && journal.read(journal.size() - 8, 8) == salvaging::rollback_magic)
    return "names a further file to be deleted";
  if (head.size() < 28 || !head.starts_with(salvaging::rollback_magic) || !is_ours(header)) return {};
  const bool young = header[format_at] != format_of_logs;
  if (u32(head, 16) == 0) {
    return young && u32(header, version_at) <= 1 ? "" : "would make the database empty";
  }
  if (u32(head, 24) != page_bytes(header)) return "is of a database with another page size";
  const std::string before = first_page_of(journal, head, page_bytes(header));
  if (before.empty()) return young ? "" : "does not name the database that it belongs to";
  if (!is_ours(before)) return "is not of a database of vip-study";
  if (same_identity(before, header) || (young && !has_identity(before))) return {};
  return "is of another database";
}

std::optional<ForeignLog> look(const fs::path& database, const std::string& header) {
  const fs::path log = database.string() + "-wal", journal = database.string() + "-journal";
  if (const std::string problem = problem_of_journal(journal, header); !problem.empty())
    return ForeignLog{journal, problem};
  if (!is_ours(header)) return {};
  if (const std::string problem = problem_of_log(Log(log), header); !problem.empty())
    return ForeignLog{log, problem};
  return {};
}

}  // namespace

std::optional<ForeignLog> foreign_log(const fs::path& database, const std::function<std::string()>& header) {
  auto found = look(database, header());
  // While another program writes, the files may be read at different moments: try again before reporting.
  for (int i = 1; found && i < tries; ++i) {
    std::this_thread::sleep_for(between_tries);
    found = look(database, header());
  }
  return found;
}

void refuse_foreign_log(const fs::path& database, const std::function<std::string()>& header) {
  const auto found = foreign_log(database, header);
  if (!found) return;
  throw base::Error(found->file.string(), found->problem + "; it was not used, and nothing was changed",
                    "move it away from " + database.string() + ", to the database that it belongs to");
}

void refuse_orphaned_log(const fs::path& database) {
  const fs::path log = database.string() + "-wal";
  const auto is_empty = [&] {
    std::error_code ignored;
    return !fs::exists(database, ignored) || fs::file_size(database, ignored) == 0;
  };
  // Checks again after reading the log, because another program may have made the database meanwhile.
  if (!is_empty() || Log(log).is_empty() || !is_empty()) return;
  throw base::Error(log.string(), "is there without its database",
                    "put the database back beside it, or save what the log and the journal of answers hold: "
                    "vip-study salvage --db " +
                        database.string() + " --into NEW");
}

}  // namespace study
