#pragma once
/// A study that takes milliseconds: consent to gaze and sharing, a personal question, two trials with gaze
/// and head poses, free text. The texts of a person contain a mark of their own (mark()), and gaze and head
/// poses a number of their own (place()).

#include <filesystem>
#include <string>
#include <vector>

namespace faults {

namespace fs = std::filesystem;

/// A participant and their answers on the consent page.
struct Person {
  std::string code, station;
  bool gaze = true, sharing = true;

  /// A text that only this person's free text and personal answers contain.
  std::string mark() const;
  /// A number that only this person's gaze and head positions contain.
  double place() const;
  std::string key() const { return code + "@" + station; }
};

/// Plans sessions for the people whom the database does not know, and plays all open units, as run and resume
/// do; at most `units` units. Records "done <key> <position>" for each acknowledged unit.
void play(const fs::path& database, const std::vector<Person>& people, int units = 1000);

/// Throws, with the lines, if something is left to clean up that the command can clean up itself. Exports and
/// backups with gaze that is now refused must be deleted by the experimenter. After an interrupted export,
/// the database may name one that was never moved into place.
void check_cleaned(const fs::path& database, std::vector<std::string> left, bool export_was_cut = false);

/// Opens the database for writing and finishes the open sessions of these people, as `vip-study resume` does.
void resume(const fs::path& database, const std::vector<Person>& people);

}  // namespace faults
