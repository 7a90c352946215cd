#pragma once
/// Work in other files that a withdrawal, a refusal of gaze or a merge requires. It is committed in the table
/// `chore` with the change, done afterwards, and then deleted. Work that a kill or a full disk left over is
/// done when the database is next opened for writing.

#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include "libstudy/store/file/sqlite.hpp"

namespace study {

/// The result of a clean-up.
struct CleanUp {
  std::vector<std::filesystem::path> cleaned;  ///< backups and personal files changed, exports deleted
  /// Files that still hold a withdrawn person or an old code: each with place, reason and remedy.
  std::vector<std::string> left;
};

/// base::Error with the number of lines in `left`, if there are any. Show the lines before.
void check_nothing_left(const std::filesystem::path& database, const std::vector<std::string>& left);

/// Adds rows to `chore` within the caller's transaction.
class ChorePlan {
 public:
  explicit ChorePlan(sqlite::Connection& database);
  /// Deletes a person from the files beside the database, where `participant` is the code.
  void forget(const std::string& person, const std::string& participant);
  /// Changes codes in the files beside the database, all at once.
  struct Rename {
    std::string before, now;
  };
  void rename(const std::map<std::string, Rename>& people);
  /// Rewrites the database file, so that it holds no bytes of deleted rows.
  void rewrite();

 private:
  void add(const char* kind, const std::string& person, const std::string& participant,
           const std::string& renamed = {});

  sqlite::Connection& database_;
  std::string batch_;
};

/// True if clean_up() has anything to do.
bool is_anything_left(sqlite::Connection& database);

/// Does all chores of a database that is open for writing under its WriterLock, deletes the exports of those
/// who withdrew (export_register.hpp), and rewrites the file when anything changed. Compare the database with
/// its journal first (AnswerJournal), so that no chores are done for a file put in its place. Does not throw
/// for failed chores: they are in `left`.
CleanUp clean_up(sqlite::Connection& database);
/// The same, and rewrites the journal of answers as announced by prepare_rewrite() (answer_journal.hpp).
CleanUp clean_up_all(sqlite::Connection& database);

}  // namespace study
