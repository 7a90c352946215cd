#pragma once
/// Parts of export_bids(). They write tables and their JSON descriptions, compute the times of a session, and
/// export headsets, head poses, gaze, questions and questionnaires.

#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "libstudy/store/export/export_folder.hpp"
#include "libstudy/store/export_labels.hpp"
#include "stats/base/json.hpp"

namespace study::bids {

using Json = base::Json;
/// A table of texts; the first line is the header.
using Table = std::vector<std::vector<std::string>>;

/// A field of a TSV file; "n/a" if it is empty or NULL. TSV has no quoting, so tabs and line ends in a text
/// become spaces. Texts that a spreadsheet would read as formulas get an apostrophe (formula_guarded()).
std::string field(std::string text);
std::string field(const sqlite::Statement& row, int column);
/// A time in ns as text in seconds.
std::string seconds(std::int64_t ns);

/// JSON description of a column; replaces "empty:" in the meaning by "n/a:", because BIDS writes missing
/// values as n/a.
Json described(const std::string& meaning);
Json described(const std::string& meaning, const std::string& unit);

/// The beginning of the paths of all files of a session, up to "_task-<protocol>". data_type: the folder in
/// the session's folder, such as "beh".
std::string stem_of(const LabelledSession& session, const std::string& data_type = "beh");

/// Writes files into a draft folder, and lists the tables among them in `files`.
class Writer {
 public:
  explicit Writer(const ExportDraft& draft) : draft_(draft) {}

  void table(const std::string& name, const Table& rows);
  /// Writes a table without its header line.
  void bare_table(const std::string& name, const Table& rows);
  /// Writes a table without its header line, compressed by gzip. Equal tables give equal bytes.
  void compressed_table(const std::string& name, const Table& rows);
  void text(const std::string& name, const std::string& text);
  void json(const std::string& name, const Json& json) { text(name, json.dump(2) + "\n"); }

  std::vector<ExportedFile> files;

 private:
  const ExportDraft& draft_;
};

/// Time since the first stimulus of a session, across all processes that played the session. If a
/// presentation starts before the end of the presentation before, the clock began anew (another computer, a
/// restart, a virtual clock). The time then continues at that end, without the pause; otherwise pauses count.
class SessionTime {
 public:
  /// Onset of the session's next presentation, ns. start_ns and end_ns are on the clock of the presentation's
  /// process; end_ns none: the presentation was cut.
  std::int64_t onset_of(std::int64_t start_ns, std::optional<std::int64_t> end_ns);
  /// End of the presentation of the last call of onset_of(), ns.
  std::int64_t end_ns() const { return end_ns_; }

 private:
  std::optional<std::int64_t> zero_ns_;
  std::int64_t end_ns_ = 0;
};

/// Onset of each presentation of a session, ns since the onset of its first stimulus, by presentation id.
std::map<std::int64_t, std::int64_t> onsets_of(sqlite::Connection& database, std::int64_t session);
/// Sampling rate from the median interval between samples, Hz. The pauses between stimuli, in which nothing
/// is recorded, hardly change the median. With fewer than two distinct times, returns the display's refresh
/// rate, or 0 if that rate is unknown.
double rate_hz(sqlite::Connection& database, std::int64_t session, const std::vector<std::int64_t>& times_ns);

/// The latest facts of a session's headset and its interpupillary distances as JSON; empty without a headset.
Json headset_of(sqlite::Connection& database, std::int64_t session);
/// Writes head poses as a motion recording ("motion/..._tracksys-headset_motion.tsv"); writes nothing without
/// head poses.
void write_motion(sqlite::Connection& database, const LabelledSession& session, Writer& writer);

/// Writes gaze samples: of an eye tracker as a physiological recording ("recording-eye1_physio.tsv.gz"), of a
/// mouse or the head's direction as behavioural data ("acq-mouse_beh.tsv", "acq-head_beh.tsv").
void write_gaze(sqlite::Connection& database, const LabelledSession& session, Writer& writer);

/// A question that becomes a column of a table.
struct Item {
  std::int64_t id = 0;
  std::string code, wording, anchors;
};

/// JSON description of a question's column, including the words of its labelled scores.
Json question_column(const Item& item);
/// The questions of a session that have scores and are not personal, restricted to the units that the SQL
/// condition `of` selects (alias u).
std::vector<Item> items(sqlite::Connection& database, std::int64_t session, const std::string& of);
/// Score and response time of the answer to a question about showing `attempt` of a unit; "n/a" if missing.
std::pair<std::string, std::string> answer_of(sqlite::Connection& database, std::int64_t unit,
                                              std::int64_t question, std::int64_t attempt);

/// Writes the answers on pages as phenotype tables: a table "ssq" with answers and scores, a table "fms" with
/// answers, a table "fms_summary" with mean and peak, and one table for each other block.
void write_phenotypes(sqlite::Connection& database, const std::vector<LabelledSession>& sessions,
                      Writer& writer);

}  // namespace study::bids
