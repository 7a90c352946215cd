#pragma once
/// Personal data, stored in a separate file. Only the participant code links them to the study's database.

#include <filesystem>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "libstudy/store/file/sqlite.hpp"

namespace study {

/// An answer to a question marked as personal.
struct PersonalEntry {
  std::string participant, question, wording, answer;
};

/// All entries of the personal file beside a database, ordered by participant and question; empty if the file
/// does not exist. Does not change the file. base::Error if the file cannot be read.
std::vector<PersonalEntry> read_personal(const std::filesystem::path& database);

/// The file "<database>.personal", a separate SQLite database that only its owner can read. Deleting the file
/// loses no study data.
class PersonalFile {
 public:
  explicit PersonalFile(const std::filesystem::path& database);

  /// Stores and commits entries; a participant's new answer to a question replaces the earlier one.
  void keep(const std::vector<PersonalEntry>& entries);
  std::vector<PersonalEntry> read(const std::string& participant);
  /// Renames participants in one transaction; `codes`: new code by old code. Does nothing if the renaming
  /// with the id `batch` was done before: one participant's new code may be another's old code, so a second
  /// renaming would be wrong.
  void rename(const std::string& batch, const std::map<std::string, std::string>& codes);
  /// Deletes the entries of a participant and overwrites their bytes.
  void forget(const std::string& participant);

  /// The path of the personal file, beside the real file if `database` is a link.
  static std::filesystem::path beside(const std::filesystem::path& database);

 private:
  std::unique_ptr<sqlite::Connection> file_;
};

}  // namespace study
