#pragma once
/// The rows of a frame log: a CSV file of PresentMon, OCAT, FrameView, CapFrameX, FRAPS, MangoHud or Unreal's
/// CSV profiler, a table with the same separators, one column of numbers, or a JSON file of CapFrameX.

#include <cstddef>
#include <filesystem>
#include <optional>
#include <sstream>
#include <string>
#include <vector>

#include "libstudy/pacing/capframex_json.hpp"

namespace study {

/// Reads a log row by row. Fields are separated by commas, semicolons or tabs, and may be quoted. Leading
/// lines that begin with "//" or "#" are comments. A row whose line does not end may be cut, and is left out.
/// base::Error at file:line for a file that is no such table, and for a blank line between rows, which may
/// stand for a missing row. Of a JSON file, base::Error at the run and the frame.
class CaptureTable {
 public:
  /// Reads the file as far as the names of the columns.
  explicit CaptureTable(const std::filesystem::path& file);

  /// The names of the columns. A file with one column of numbers and no name has one empty name.
  const std::vector<std::string>& names() const { return names_; }
  bool named() const { return named_; }
  bool mangohud() const { return mangohud_; }  ///< true: MangoHud's description of the computer came first
  const std::string& file() const { return file_; }
  /// True if next() left out the last row, because its line does not end.
  bool cut() const { return cut_; }

  /// Sets `fields` to the next row, with one field for each name; false at the end.
  bool next(std::vector<std::string>& fields);

  /// The index of the column with this name, in upper or lower case; none if no column has the name.
  /// base::Error if two columns have it.
  std::optional<std::size_t> place_of(const std::string& wanted) const;
  /// The index of the column that the user named. base::Error if there is no such column.
  std::size_t chosen(const std::string& wanted) const;

  /// The number in a field, whose decimal sign may be a comma if commas do not separate fields.
  std::optional<double> number_in(std::string text) const;
  /// The frame time in a field, ms; none if `may_lack` and the field is 0 or "NA". base::Error for any other
  /// field that is no frame time from shortest_trace_ms to longest_trace_ms.
  std::optional<double> frame_time(const std::string& text, bool may_lack) const;
  /// Returns `ms`. base::Error if it is not from shortest_trace_ms to longest_trace_ms.
  double checked_time(double ms) const;

  /// Throws a base::Error at the line that was read last.
  [[noreturn]] void fail(const std::string& problem, const std::string& mend) const;
  /// The same; the mend names the files that can be read.
  [[noreturn]] void fail(const std::string& problem) const;

 private:
  std::string text_of(const std::filesystem::path& file);
  bool next_line(std::string& line);

  std::string file_;
  std::optional<CapFrameXLog> json_;  ///< without its text; none: the file is no JSON
  std::istringstream lines_;
  int number_ = 0;  ///< number of the last line read, from 1
  int blank_ = 0;   ///< number of a blank line before it; 0: none
  char separator_ = ',';
  std::vector<std::string> names_, first_row_;  ///< first_row_: a row that was read where names were expected
  bool named_ = false, first_ = true, mangohud_ = false, cut_ = false;
  std::size_t later_fields_ = 0;  ///< number of fields of the rows after the first
};

/// `text` in lower case (ASCII).
std::string folded_name(std::string text);

}  // namespace study
