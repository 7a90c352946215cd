#pragma once
/// A mapping file: which columns of another program's table hold what vip-study import needs. docs/data.md
/// describes each key; protocols/import holds mappings for PsychoPy, jsPsych, UXF and vip-study itself.

#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <vector>

namespace study {

/// A row is read only if `column` holds one of these texts; without texts: if it is not empty.
struct RowCondition {
  std::string column;
  std::vector<std::string> is;
};

/// Where an answer to one question stands.
struct AnswerColumn {
  std::string question;  ///< id of the question in the protocol
  std::string column;
  std::string key;  ///< the field is a JSON object, and the answer is its value of this key
  /// Two columns, of what was shown first and second: the answer is 1 if the field equals that of the first,
  /// 2 if it equals that of the second. Empty: the field itself is the answer.
  std::vector<std::string> choice_of;
  int add = 0;                        ///< added to a number, such as 1 where a scale is counted from 0
  std::map<std::string, int> scores;  ///< the score of each text; empty: the field holds numbers
  std::vector<RowCondition> when;     ///< conditions on rows that hold this answer
  std::string response_time_column;   ///< empty: not recorded
  double response_time_unit_s = 1;    ///< length of the column's unit, s
};

/// A column of numbers with the length of its unit in s.
struct TimeColumn {
  std::string column;  ///< empty: none
  double unit_s = 1;
};

/// Columns that say what one stimulus was.
struct StimulusColumns {
  /// "mean_fps", "sd_fps", "scene", "method", "n_star", "effects", "shown_mean_fps",
  /// "shown_mean_arithmetic_fps", "shown_sd_fps". A key that the mapping leaves out is absent.
  std::map<std::string, std::string> columns;
  std::map<std::string, std::string> factors;  ///< column of each factor of a protocol of format 3
  /// Path of the frame log, with {column} for the text in a column; empty: none.
  std::string frames_file;

  bool empty() const { return columns.empty() && factors.empty(); }
};

struct ImportMapping {
  std::string text, sha256;            ///< the file, and its hash
  std::string tool;                    ///< the program that wrote the tables
  std::vector<std::string> files;      ///< names of the tables in a folder; "*" stands for any characters
  std::optional<std::string> sharing;  ///< "allowed" or "refused"
  std::string consent;                 ///< where the consent to take part is recorded; empty: not stated
  std::string incomplete;              ///< "stopped" or "dropped out"; empty: refuse incomplete sessions
  std::string utc_offset;              ///< such as "+02:00", of times without one; empty: not stated
  std::vector<std::string> missing;    ///< texts that stand for no answer
  std::vector<std::string> not_asked;  ///< questions of the protocol that were not asked
  bool rows_in_order = false;          ///< true: the rows are in the order of the trials
  bool test_data = false;
  std::string only_person;  ///< all rows are of this person; empty: `columns` names the person's column
  std::vector<RowCondition> rows;

  /// Columns by what they hold: "person", "visit", "order", "observer", "test_data", "answered", "started". A
  /// key that the mapping leaves out is absent.
  std::map<std::string, std::string> columns;
  StimulusColumns stimulus;       ///< of the only stimulus, or of what both of a pair have
  StimulusColumns first, second;  ///< of the two of a pair; empty: trials show one stimulus
  TimeColumn onset;               ///< of the stimulus, or of the first
  std::vector<AnswerColumn> answers;

  std::string frames_column;     ///< column of the frame log; empty: the usual ones (read_frame_logs())
  bool frames_may_lack = false;  ///< true: a trial without a frame log has no recorded timing

  bool pairs() const { return !first.empty() || !second.empty(); }
  /// The stimuli of a trial, in their order.
  std::vector<const StimulusColumns*> stimuli() const {
    if (!pairs()) return {&stimulus};
    return {&first, &second};
  }
};

/// Returns the given path if the file exists, else a mapping that ships with the project, by its name alone
/// ("psychopy"). base::Error if there is neither.
std::filesystem::path find_mapping(const std::filesystem::path& named);

/// base::Error at file:line:column for an unknown key, a wrong type, or keys that contradict each other.
ImportMapping read_mapping(const std::filesystem::path& file);

}  // namespace study
