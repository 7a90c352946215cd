#pragma once
/// The log of a light sensor on the display: a table with a time, a level and, where it was recorded, a
/// trigger line.

#include <filesystem>
#include <string>
#include <vector>

namespace study {

/// What the user says about a log; empty: the log's first line says it.
struct SensorChoice {
  std::string unit;                  ///< of its times: "s", "ms" or "us"
  std::vector<std::string> columns;  ///< names or numbers (from 1): time, level and, if any, trigger
};

struct SensorLog {
  std::string sha256;   ///< of the file
  std::string format;   ///< in words: which columns were read, in which unit
  bool events = false;  ///< rows stand where a line changed, and not at even intervals
  /// Seconds since the first row, ascending. Levels and triggers are in the units of the log.
  std::vector<double> time_s;
  std::vector<float> level, trigger;  ///< trigger: empty if the log has no such column
  double interval_s = 0;              ///< median time between rows; of events: the resolution of their times
  std::vector<std::string> remarks;   ///< what was left out
  /// Seconds between which rows are missing (five median intervals and 10 ms or more); none of events.
  struct Gap {
    double from_s = 0, to_s = 0;
  };
  std::vector<Gap> gaps;
};

/// Reads a log. Its fields are separated by commas, semicolons, tabs or blanks; decimal commas need another
/// separator than the comma. Lines that begin with "#" or "//" are comments. Formats:
///
/// - a first line with names, such as time_ms,level,trigger: the unit ends the name of the time column, or
///   stands there in brackets (s, ms, us); lsl_timestamp is in seconds, micros and millis are what they say;
/// - lines of an Arduino without names: `unit` is needed. A first line that was cut, and the time that the
///   Arduino IDE writes before "->", are left out; a count of microseconds may begin again after 2^32;
/// - events of a Black Box ToolKit v2 (timestamp in ms, Opto1 to Opto4, TTLin1): Opto1 is read.
///
/// A last line without an end may be cut, and is left out. base::Error at file:line for a field that is no
/// number (also NaN), another number of fields, or times that do not ascend; at the file if it is empty, has
/// more than most_sensor_rows rows, lasts longer than a day, if columns or unit are not clear, if `unit` and
/// names contradict each other, or if rows are closer than 2 us or farther apart than 20 ms, as with a wrong
/// unit.
SensorLog read_sensor_log(const std::filesystem::path& file, const SensorChoice& choice);

inline constexpr std::size_t most_sensor_rows = 50'000'000;

}  // namespace study
