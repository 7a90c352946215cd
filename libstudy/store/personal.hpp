#pragma once
/// Personal data apart from the study's database, joined to it by the participant code alone.

#include <filesystem>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "libstudy/store/sqlite.hpp"

namespace study {

/// What a question marked as personal was answered with.
struct PersonalEntry {
  std::string participant, question, wording, answer;
};

/// All that stands beside the database, which is not changed, in the order of participants and questions;
/// empty where there is no such file. base::Error: it cannot be read.
std::vector<PersonalEntry> read_personal(const std::filesystem::path& database);

/// "<database>.personal": a SQLite file of its own, readable by its owner only. Deleting it takes nothing
/// from the study.
class PersonalFile {
 public:
  explicit PersonalFile(const std::filesystem::path& database);

  /// Commits; an answer to the same question replaces the former one.
  void keep(const std::vector<PersonalEntry>& entries);
  std::vector<PersonalEntry> read(const std::string& participant);
  /// Gives participants other codes (by the one before), all at once. What was done under the same `batch` is
  /// not done again: the new code of one may be the former one of another.
  void rename(const std::string& batch, const std::map<std::string, std::string>& codes);
  /// Deletes what stands of a participant and overwrites where it stood.
  void forget(const std::string& participant);

  /// Beside the real file, whatever link leads to it.
  static std::filesystem::path beside(const std::filesystem::path& database);

 private:
  std::unique_ptr<sqlite::Connection> file_;
};

}  // namespace study
