#include "libstudy/store/export/presentmon.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cstdint>
#include <optional>
#include <vector>

#include "stats/base/new_file.hpp"

namespace study {

using sqlite::Connection;
using sqlite::Statement;

namespace {

constexpr const char* presentmon_folder = "presentmon/showing_";

/// A frame's submission and its reported onset, on the session's clock, ns.
struct Presented {
  std::int64_t submitted_ns = 0;
  std::optional<std::int64_t> shown_ns;
};

/// A time in ns with all its digits in ms (digits = 6) or s (digits = 9).
std::string decimal(std::int64_t ns, int digits) {
  std::string text = fmt::format("{:0{}}", ns, digits + 1);
  return text.insert(text.size() - static_cast<std::size_t>(digits), ".");
}

/// True if the times of submission ascend, and the onsets too if each frame has one.
bool ascends(const std::vector<Presented>& frames, bool with_onsets) {
  return std::adjacent_find(frames.begin(), frames.end(), [&](const Presented& one, const Presented& next) {
           return next.submitted_ns <= one.submitted_ns || (with_onsets && *next.shown_ns <= *one.shown_ns);
         }) == frames.end();
}

/// The frames of a showing; empty if the time of a submission is not known.
std::vector<Presented> frames_of(Connection& database, std::int64_t showing) {
  std::vector<Presented> out;
  Statement row(database,
                "SELECT coalesce(start_ns, 0) + scheduled_ns + submitted_ns, "
                "coalesce(start_ns, 0) + scheduled_ns + actual_display_ns "
                "FROM frame JOIN presentation USING (presentation_id) WHERE presentation_id = ? "
                "ORDER BY frame_index");
  for (row.bind_all(showing); row.step();) {
    if (row.is_null(0)) return {};
    Presented& frame = out.emplace_back(Presented{row.integer(0), {}});
    if (!row.is_null(1)) frame.shown_ns = row.integer(1);
  }
  return out;
}

/// source: the first three fields of each row.
void write_frames(ExportFile& file, const std::vector<std::string>& source,
                  const std::vector<Presented>& frames, bool with_onsets, const CsvDialect& dialect) {
  std::vector<std::string> names;
  for (const ColumnMeaning& column : presentmon_columns()) names.push_back(column.column);
  if (!with_onsets) names.pop_back();
  file.write(csv_head(names, dialect));
  for (std::size_t i = 0; i < frames.size(); ++i) {
    const auto since_last = [&](std::int64_t now_ns, std::int64_t last_ns) {
      return i == 0 ? "NA" : csv_number(decimal(now_ns - last_ns, 6), dialect);
    };
    const Presented &frame = frames[i], &last = frames[i == 0 ? 0 : i - 1];
    std::vector<std::string> fields = source;
    fields.push_back(csv_number(decimal(frame.submitted_ns - frames.front().submitted_ns, 9), dialect));
    fields.push_back(since_last(frame.submitted_ns, last.submitted_ns));
    if (with_onsets) fields.push_back(since_last(*frame.shown_ns, *last.shown_ns));
    file.write(csv_line(fields, dialect));
  }
}

}  // namespace

std::span<const ColumnMeaning> presentmon_columns() {
  static const std::vector<ColumnMeaning> columns{
      {"", "Application", "TEXT", "vip-study"},
      {"", "ProcessID", "INTEGER", "session_id"},
      {"", "SwapChainAddress", "TEXT", "presentation_id, hexadecimal"},
      {"", "TimeInSeconds", "REAL", "submission of the frame, after that of the first frame, s"},
      {"", "MsBetweenPresents", "REAL", "time since the submission of the frame before, ms; NA: first frame"},
      {"", "MsBetweenDisplayChange", "REAL",
       "time since the reported onset of the frame before, ms; NA: first frame"}};
  return columns;
}

ExportedFile write_presentmon(Connection& database, const ExportDraft& draft) {
  base::make_folder_of(draft.path() / presentmon_folder);
  std::int64_t rows = 0, written = 0, left_out = 0;
  Statement showing(
      database,
      "SELECT presentation_id, session_id, CASE WHEN grade = 'D' AND p.state = 'played' "
      "THEN end_ns END FROM presentation p JOIN trial USING (trial_id) ORDER BY presentation_id");
  while (showing.step()) {
    const std::int64_t id = showing.integer(0);
    std::vector<Presented> frames = frames_of(database, id);
    const bool with_onsets = std::all_of(frames.begin(), frames.end(),
                                         [](const Presented& frame) { return frame.shown_ns.has_value(); });
    if (!showing.is_null(2) && !frames.empty() && !with_onsets) frames.push_back({showing.integer(2), {}});
    if (frames.size() < 2 || !ascends(frames, with_onsets)) {
      ++left_out;
      continue;
    }
    ExportFile file(draft, presentmon_folder + std::to_string(id) + ".csv");
    write_frames(file, {"vip-study", std::to_string(showing.integer(1)), fmt::format("0x{:016X}", id)},
                 frames, with_onsets, draft.dialect());
    file.finish();
    rows += static_cast<std::int64_t>(frames.size());
    ++written;
  }
  return {fmt::format("presentmon ({} showings, {} left out)", written, left_out), rows};
}

bool is_presentmon_name(const std::string& name) {
  return name.starts_with(presentmon_folder) && name.ends_with(".csv");
}

}  // namespace study
