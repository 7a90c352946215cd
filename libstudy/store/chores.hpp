#pragma once
/// What is to be done in other files when a withdrawal or a merge is committed. It stands in the table
/// `chore` of the same commit, is done afterwards, and is deleted when done; what a kill or a full disk
/// leaves is done at the next opening for writing.

#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include "libstudy/store/sqlite.hpp"

namespace study {

/// What came of a clean-up.
struct CleanUp {
  std::vector<std::filesystem::path> cleaned;  ///< backups and personal files changed, exports deleted
  /// What still holds somebody who withdrew, or an old code: each with its place, the reason and the mend.
  std::vector<std::string> left;
};

/// base::Error that says how much is left, where something is: its lines were shown before.
void check_nothing_left(const std::filesystem::path& database, const std::vector<std::string>& left);

/// Rows of `chore`, within a transaction of the caller.
class ChorePlan {
 public:
  explicit ChorePlan(sqlite::Connection& database);
  /// A person is to be deleted from the files beside the database, which know them by `participant`.
  void forget(const std::string& person, const std::string& participant);
  /// Those who stay get new codes there, all at once. Codes by person: now, and to be.
  struct Rename {
    std::string before, now;
  };
  void rename(const std::map<std::string, Rename>& people);
  /// The file itself is to be written anew, so that nothing stands in it but what its tables hold.
  void rewrite();

 private:
  void add(const char* kind, const std::string& person, const std::string& participant,
           const std::string& renamed = {});

  sqlite::Connection& database_;
  std::string batch_;
};

/// Whether clean_up() has anything to do.
bool is_anything_left(sqlite::Connection& database);

/// Does all chores of a database that is open for writing under its WriterLock, deletes the exports of those
/// who withdrew (export_register.hpp), and rewrites the file when anything changed. Compare the database with
/// its journal first (AnswerJournal): another file in its place has nothing done for it. Never throws for
/// what cannot be done: that is `left`.
CleanUp clean_up(sqlite::Connection& database);
/// The same with the journal of answers made anew, as prepare_rewrite() announced (answer_journal.hpp).
CleanUp clean_up_all(sqlite::Connection& database);

}  // namespace study
