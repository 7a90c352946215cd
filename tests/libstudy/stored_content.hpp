#pragma once
/// What a database holds, as lines of text that tests compare.

#include <algorithm>
#include <filesystem>
#include <string>
#include <vector>

#include "libstudy/store/file/database.hpp"

namespace study::test {

using Lines = std::vector<std::string>;

/// The rows of a query, with '|' between columns and '~' for NULL.
inline Lines select(const std::filesystem::path& path, const std::string& sql) {
  const auto database = open_database(path, sqlite::Open::Read, read_schema_steps());
  sqlite::Statement row(*database, sql);
  Lines lines;
  while (row.step()) {
    std::string line;
    for (int i = 0; i < row.columns(); ++i) line += (i ? "|" : "") + (row.is_null(i) ? "~" : row.text(i));
    lines.push_back(line);
  }
  return lines;
}

/// Every row of every table, with row numbers. Public labels are left out, because the target of a merge
/// keeps its own labels.
inline Lines everything(const std::filesystem::path& path) {
  Lines all;
  for (const std::string& table :
       select(path, "SELECT name FROM sqlite_schema WHERE type = 'table' ORDER BY 1")) {
    if (table == "label") continue;
    all.push_back("-- " + table);
    for (std::string& line : select(path, "SELECT * FROM \"" + table + "\" ORDER BY 1, 2"))
      all.push_back(line);
  }
  return all;
}

/// The content of the sessions, without row numbers and codes: it must be the same in every copy.
inline Lines contents(const std::filesystem::path& path) {
  Lines all;
  for (const char* sql : {
           "SELECT s.uid, s.person, s.code, s.visit, s.seed, s.slot, s.state, s.test_data, s.observer, "
           "s.clock, "
           "s.display, s.stimulus, s.machine, s.station, s.time_zone, s.gaze_source, s.ptpe, s.started_utc, "
           "s.ended_utc, r.uid, r.started_utc, r.options, p.sha256 FROM session s JOIN run r USING (run_id) "
           "JOIN protocol p USING (protocol_id)",
           "SELECT s.uid, f.scene, f.width_px, f.camera_angle_deg, f.visual_angle_deg, f.angle_ratio, "
           "f.cells, f.copied, f.renderer FROM framing f "
           "JOIN session s USING (session_id)",
           "SELECT s.uid, u.position, u.block, u.block_index, u.kind, u.state, u.done_utc, t.position, "
           "t.group_index, t.first_cell, t.second_cell, t.schedule_seed, t.state, t.set_aside, t.excluded "
           "FROM unit u JOIN session s USING (session_id) LEFT JOIN trial t USING (trial_id)",
           "SELECT s.uid, t.position, p.attempt, p.interval, p.cell, p.state, p.start_ns, p.end_ns, "
           "p.verdict, "
           "p.mean_fps, p.sd_fps, p.reason FROM presentation p JOIN trial t USING (trial_id) "
           "JOIN session s USING (session_id)",
           "SELECT s.uid, t.position, p.attempt, p.interval, f.frame_index, f.content_step, f.scheduled_ns, "
           "f.submitted_ns, f.particles, f.active_fraction, f.tau_fps, f.gaze_lost FROM frame f JOIN "
           "presentation p USING "
           "(presentation_id) "
           "JOIN trial t USING (trial_id) JOIN session s USING (session_id)",
           "SELECT s.uid, u.position, r.attempt, q.code, q.wording, r.score, r.words, r.response_time_s, "
           "r.answered_utc FROM response r JOIN unit u USING (unit_id) JOIN session s USING (session_id) "
           "JOIN question q USING (question_id)",
           "SELECT s.uid, u.position, n.utc, n.words FROM note n JOIN session s USING (session_id) "
           "LEFT JOIN unit u USING (unit_id)",
           "SELECT s.uid, p.start_ns, e.utc, e.clock_ns, e.kind, e.detail FROM event e "
           "JOIN session s USING (session_id) LEFT JOIN presentation p USING (presentation_id)",
       }) {
    for (std::string& line : select(path, sql)) all.push_back(line);
  }
  std::sort(all.begin(), all.end());
  return all;
}

inline Lines joined(const std::vector<std::filesystem::path>& paths) {
  Lines all;
  for (const std::filesystem::path& path : paths) {
    for (std::string& line : contents(path)) all.push_back(line);
  }
  std::sort(all.begin(), all.end());
  return all;
}

}  // namespace study::test
