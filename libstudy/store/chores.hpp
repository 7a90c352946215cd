#pragma once
/// Chores: clean-up work outside the database's rows, required by a withdrawal, a refusal of gaze or a merge.
/// A chore is a row of the table `chore`, committed together with the change that requires it. The program
/// does the chore afterwards and then deletes its row. A chore that a kill or a full disk left undone is done
/// by the next Store, withdrawal, merge or change of permissions.

#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include "libstudy/store/file/sqlite.hpp"

namespace study {

/// The result of a clean-up.
struct CleanUp {
  std::vector<std::filesystem::path> cleaned;  ///< backups and personal files changed, exports deleted
  /// Clean-ups that failed, such as files that still contain data of a withdrawn person, refused gaze or an
  /// old code; each with path, reason and remedy.
  std::vector<std::string> left;
};

/// base::Error with the number of lines in `left` (CleanUp::left), if there are any. Show the lines to the
/// user first, because the error refers to them.
void check_nothing_left(const std::filesystem::path& database, const std::vector<std::string>& left);

/// Adds rows to the table `chore` within the caller's transaction.
class ChorePlan {
 public:
  explicit ChorePlan(sqlite::Connection& database);
  /// Plans to delete a person from the backups and the personal file beside the database. `participant` is
  /// the person's code in the personal file.
  void forget(const std::string& person, const std::string& participant);
  /// A change of a participant's code in the personal file beside the database. rename() plans the changes of
  /// all `people` as one chore; the key of the map is the person.
  struct Rename {
    std::string before, now;
  };
  void rename(const std::map<std::string, Rename>& people);
  /// Plans to rewrite the database file, so that it contains no bytes of deleted rows.
  void rewrite();

 private:
  void add(const char* kind, const std::string& person, const std::string& participant,
           const std::string& renamed = {});

  sqlite::Connection& database_;
  std::string batch_;
};

/// True if clean_up() has work: a chore, or an export on this computer, or on a computer that is not
/// recorded, with data of a withdrawn person.
bool is_anything_left(sqlite::Connection& database);

/// Does all chores of a database that is open for writing under its WriterLock. Deletes the exports that
/// contain withdrawn people (export_register.hpp), and rewrites the database file if a chore requires it.
/// Compare the database with its journal first (AnswerJournal), so that no chores are done for another
/// database at the same path. Does not throw if a chore fails: the result lists it in `left`.
CleanUp clean_up(sqlite::Connection& database);
/// Does clean_up(), then rewrites the journal of answers, which prepare_rewrite() (answer_journal.hpp)
/// announced.
CleanUp clean_up_all(sqlite::Connection& database);

}  // namespace study
