#pragma once
/// A study that takes milliseconds: consent to gaze and sharing, something personal, two trials with gaze and
/// poses of the head, free words. Everything that a person leaves behind is told by a mark of their own.

#include <filesystem>
#include <string>
#include <vector>

namespace faults {

namespace fs = std::filesystem;

/// Who takes part, and what they say on the consent page.
struct Person {
  std::string code, station;
  bool gaze = true, sharing = true;

  /// Stands in the words and the personal answer of this person alone.
  std::string mark() const;
  /// Where the person looks and where the head is; of this person alone.
  double place() const;
  std::string key() const { return code + "@" + station; }
};

/// Plans whom of these the database does not know, and goes through everything that is open, as run and
/// resume do; at most so many units. Records "done <key> <position>" for each unit that is acknowledged.
void play(const fs::path& database, const std::vector<Person>& people, int units = 1000);

/// Throws, with each line, where something is left to clean that the command can clean itself. Exports and
/// backups that hold gaze which is refused now are for the experimenter to delete. After an export that was
/// cut off, the database may name one that never came into its place.
void check_cleaned(const fs::path& database, std::vector<std::string> left, bool export_was_cut = false);

/// Opens for writing and finishes what is open, as resume does.
void resume(const fs::path& database, const std::vector<Person>& people);

}  // namespace faults
