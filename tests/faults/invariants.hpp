#pragma once
/// Invariants of a study's files after any command and any fault, checked with separate SQL and byte by byte,
/// so that no code of the store is trusted:
///
/// - refused: people who refused gaze have no row of gaze, head or gaze_validation, and none in any export;
///   people who refused sharing are in no public export.
/// - tombstone: the mark of a person who withdrew (a text that only this person's answers contain) and this
///   person's gaze position are in no file of the station and in no export.
/// - acknowledged: an acknowledged answer is in the database and in its journal, and personal answers are in
///   the file of personal data.
/// - "refused": a command that says that it changed nothing left every file unchanged.
/// - merging twice equals merging once, in any order (the caller compares describe() of both).
///
/// Each check returns the problems, one line each; empty if it holds.

#include <filesystem>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "tests/faults/small_study.hpp"

namespace faults {

using Problems = std::vector<std::string>;

/// A session as its rows describe it.
struct SessionFacts {
  std::string person, participant, code, station, state;
  std::optional<bool> gaze, sharing;          ///< the last decision; none: not answered yet
  int gaze_changes = 0, sharing_changes = 0;  ///< decisions after the consent page
  int gaze_rows = 0;                          ///< rows in the tables gaze, head and gaze_validation
  std::set<int> done;                         ///< positions of the finished units
  std::vector<std::string> answers;           ///< "position question score words"
  std::string key() const { return code + "@" + station; }
};

/// An answer in the database.
struct Response {
  std::string key;  ///< Person::key()
  int position = 0;
  std::string row;  ///< "response_id score words"
};

/// Content of a database, read from a copy of it and its log.
struct DatabaseFacts {
  bool there = false;                            ///< it is a database with the tables of a study
  std::map<std::string, SessionFacts> sessions;  ///< by Person::key()
  std::set<std::string> withdrawn;  ///< people in the table of withdrawals (tombstone), by Person::key()
  std::vector<Response> responses;
  std::set<std::string> personal;  ///< answers in the file of personal data
};
/// `peek`: a folder for the copy, emptied first. Data that cannot be read are a problem.
DatabaseFacts read_facts(const fs::path& database, const fs::path& peek, Problems& problems);

/// Sessions, decisions, answers, gaze and tombstones of all people, for comparing databases.
std::vector<std::string> describe(const DatabaseFacts& facts);

Problems check_refused(const DatabaseFacts& facts);

/// Makes each export from a copy of the station's folder, in its own process, and searches it. `gone`: people
/// who withdrew as far as this station knows.
Problems check_exports(const DatabaseFacts& facts, const fs::path& station, const fs::path& peek,
                       const std::vector<Person>& gone);

Problems check_withdrawn(const fs::path& station, const std::vector<Person>& gone);

/// acknowledged: Person::key() and position of each unit answered at this station. People who withdrew do not
/// count. settled: the database was opened for writing since the last fault, so that its journal has every
/// answer, also those of a merge or an upgrade.
Problems check_acknowledged(const DatabaseFacts& facts, const fs::path& database,
                            const std::set<std::pair<std::string, int>>& acknowledged, bool settled);

/// Name and bytes of every file below a folder, except log indexes.
std::map<std::string, std::string> bytes_of_folder(const fs::path& folder);
Problems check_unchanged(const std::map<std::string, std::string>& before, const fs::path& folder);

}  // namespace faults
