#pragma once
/// Parts of export_bids(): tables and sidecars in a draft, the times of a session, its headset, head poses
/// and gaze, questions as columns, and the pages of questionnaires.

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
/// A table of texts, the first line its header.
using Table = std::vector<std::vector<std::string>>;

/// A field of a TSV file, which has no quoting; "n/a" if empty. Texts are formula_guarded().
std::string field(std::string text);
std::string field(const sqlite::Statement& row, int column);
/// Seconds as text.
std::string seconds(std::int64_t ns);

/// The description of a column; the schema's "empty" becomes BIDS's n/a.
Json described(const std::string& meaning);
Json described(const std::string& meaning, const std::string& unit);

/// Folder and file name prefix of a session's files.
std::string stem_of(const LabelledSession& session, const std::string& data_type = "beh");

/// Puts files into a draft and remembers the tables.
class Writer {
 public:
  explicit Writer(const ExportDraft& draft) : draft_(draft) {}

  void table(const std::string& name, const Table& rows);
  /// A table without its header line.
  void bare_table(const std::string& name, const Table& rows);
  /// A table without its header line, compressed by gzip: the same table gives the same bytes.
  void compressed_table(const std::string& name, const Table& rows);
  void text(const std::string& name, const std::string& text);
  void json(const std::string& name, const Json& json) { text(name, json.dump(2) + "\n"); }

  std::vector<ExportedFile> files;

 private:
  const ExportDraft& draft_;
};

/// Times since the first stimulus of a session, across all processes that played it. A later process
/// continues where the former ended, without the pause between.
class SessionTime {
 public:
  /// Onset of the session's next presentation. Arguments are on the clock of its process; no end: it was cut.
  std::int64_t onset_of(std::int64_t start_ns, std::optional<std::int64_t> end_ns);
  /// End of the presentation that onset_of() was given last.
  std::int64_t end_ns() const { return end_ns_; }

 private:
  std::optional<std::int64_t> zero_ns_;
  std::int64_t end_ns_ = 0;
};

/// Onset of each presentation of a session since its first stimulus.
std::map<std::int64_t, std::int64_t> onsets_of(sqlite::Connection& database, std::int64_t session);
/// Sampling rate by the usual interval, Hz, since nothing is recorded between stimuli. With fewer than two
/// times, the display's rate; 0 if that is unknown.
double rate_hz(sqlite::Connection& database, std::int64_t session, const std::vector<std::int64_t>& times_ns);

/// The facts of a session's headset and the distances between the eyes; empty without a headset.
Json headset_of(sqlite::Connection& database, std::int64_t session);
/// Writes head poses as a motion recording ("motion/..._tracksys-headset_motion.tsv").
void write_motion(sqlite::Connection& database, const LabelledSession& session, Writer& writer);

/// Writes gaze: samples of an eye tracker as an eye recording ("recording-eye1_physio.tsv.gz"), those of a
/// mouse as behaviour ("acq-mouse_beh.tsv").
void write_gaze(sqlite::Connection& database, const LabelledSession& session, Writer& writer);

/// A question as a column.
struct Item {
  std::int64_t id = 0;
  std::string code, wording, anchors;
};

/// Describes a question's column, including the words at its scores.
Json question_column(const Item& item);
/// Questions with scores asked in trials or on pages of a block; `of`: SQL condition on unit u.
std::vector<Item> items(sqlite::Connection& database, std::int64_t session, const std::string& of);
/// Score and response time of a question at a showing (`attempt`).
std::pair<std::string, std::string> answer_of(sqlite::Connection& database, std::int64_t unit,
                                              std::int64_t question, std::int64_t attempt);

/// Writes the pages as phenotype tables: SSQ with its scores and FMS with mean and peak by kind, other pages
/// by block.
void write_phenotypes(sqlite::Connection& database, const std::vector<LabelledSession>& sessions,
                      Writer& writer);

}  // namespace study::bids
