#pragma once
/// Parts of export_bids(): tables and sidecars in a draft, and when things happened in a session.

#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "libstudy/store/export_folder.hpp"
#include "libstudy/store/export_labels.hpp"
#include "stats/base/json.hpp"

namespace study::bids {

using Json = base::Json;
/// A table of texts, the first line its header.
using Table = std::vector<std::vector<std::string>>;

/// A field of a TSV file, which knows no quotes; "n/a" when there is nothing. Texts are formula_guarded().
std::string field(std::string text);
std::string field(const sqlite::Statement& row, int column);
/// Seconds as text.
std::string seconds(std::int64_t ns);

/// What a column means; where the schema says "empty", BIDS writes n/a.
Json described(const std::string& meaning);
Json described(const std::string& meaning, const std::string& unit);

/// Folder and beginning of the name of a session's files.
std::string stem_of(const LabelledSession& session, const std::string& data_type = "beh");

/// Puts files into a draft and remembers the tables.
class Writer {
 public:
  explicit Writer(const ExportDraft& draft) : draft_(draft) {}

  void table(const std::string& name, const Table& rows);
  /// Without a header line.
  void bare_table(const std::string& name, const Table& rows);
  /// Without a header line, compressed by gzip: the same table gives the same bytes.
  void compressed_table(const std::string& name, const Table& rows);
  void text(const std::string& name, const std::string& text);
  void json(const std::string& name, const Json& json) { text(name, json.dump(2) + "\n"); }

  std::vector<ExportedFile> files;

 private:
  const ExportDraft& draft_;
};

/// Times from the first stimulus of a session, over all processes that played it: what another process shows
/// follows as if there had been no pause.
class SessionTime {
 public:
  /// Of the session's next presentation, on the clock of its process; no end: cut short.
  std::int64_t onset_of(std::int64_t start_ns, std::optional<std::int64_t> end_ns);
  /// The end of that presentation.
  std::int64_t end_ns() const { return end_ns_; }

 private:
  std::optional<std::int64_t> zero_ns_;
  std::int64_t end_ns_ = 0;
};

/// When each presentation of a session began, from the first stimulus.
std::map<std::int64_t, std::int64_t> onsets_of(sqlite::Connection& database, std::int64_t session);
/// Of the usual interval, Hz: between two stimuli nothing is recorded. Of fewer than two times the display's;
/// 0: that is not known either.
double rate_hz(sqlite::Connection& database, std::int64_t session, const std::vector<std::int64_t>& times_ns);

/// What the headset of a session was, and the distances between the eyes; empty: none was worn.
Json headset_of(sqlite::Connection& database, std::int64_t session);
/// How the head moved, as a recording of motion ("motion/..._tracksys-headset_motion.tsv").
void write_motion(sqlite::Connection& database, const LabelledSession& session, Writer& writer);

/// Where the participant of a session looked: samples of an eye tracker as a recording of the eye
/// ("recording-eye1_physio.tsv.gz"), the mouse, which is none, as behaviour ("acq-mouse_beh.tsv").
void write_gaze(sqlite::Connection& database, const LabelledSession& session, Writer& writer);

}  // namespace study::bids
