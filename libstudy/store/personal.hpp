#pragma once
/// Personal data, stored apart from the study's database and linked to it only by the participant code.

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

/// All entries of the personal file beside a database, ordered by participant and question; empty if there is
/// no such file. Changes nothing. base::Error: it cannot be read.
std::vector<PersonalEntry> read_personal(const std::filesystem::path& database);

/// "<database>.personal": a SQLite file of its own, readable by its owner only. Deleting it loses no study
/// data.
class PersonalFile {
 public:
  explicit PersonalFile(const std::filesystem::path& database);

  /// Stores and commits entries; an answer to the same question replaces the former one.
  void keep(const std::vector<PersonalEntry>& entries);
  std::vector<PersonalEntry> read(const std::string& participant);
  /// Renames participants (new code by old code), all at once. A `batch` that was done is not repeated,
  /// because the new code of one may be the old code of another.
  void rename(const std::string& batch, const std::map<std::string, std::string>& codes);
  /// Deletes the entries of a participant and overwrites their bytes.
  void forget(const std::string& participant);

  /// The path of the personal file, beside the real file if `database` is a link.
  static std::filesystem::path beside(const std::filesystem::path& database);

 private:
  std::unique_ptr<sqlite::Connection> file_;
};

}  // namespace study
