#pragma once
/// The prepared statements of a Store that run for every frame, showing or answer.

#include "libstudy/store/store.hpp"

namespace study {

struct Store::Statements {
  explicit Statements(sqlite::Connection& database)
      : frame(database,
              "INSERT INTO frame VALUES "
              "(?,?,?,?,?,?,?,?,?,?,?,?,?,?,?,?,?,?,?,?,?,?,?,?)"),
        event(database,
              "INSERT INTO event (session_id, presentation_id, utc, clock_ns, kind, detail) VALUES "
              "(?,?,?,?,?,?)"),
        begin(database,
              "INSERT INTO presentation (trial_id, attempt, interval, cell, state, started_utc, start_ns, "
              "framing_id, gaze_source) SELECT ?1, ?2, ?3, ?4, 'running', ?5, ?6, (SELECT max(f.framing_id) "
              "FROM "
              "trial t JOIN framing f USING (session_id) WHERE t.trial_id = ?1 AND "
              "instr(' ' || f.cells || ' ', ' ' || ?4 || ' ')), coalesce(?7, (SELECT gaze_source FROM trial "
              "JOIN session USING (session_id) WHERE trial_id = ?1))"),
        end(database,
            "UPDATE presentation SET state = 'played', end_ns = ?, verdict = ?, grade = ?, reason = ?, "
            "frames = ?, mean_fps = ?, mean_arithmetic_fps = ?, sd_fps = ?, p95_ms = ?, longest_ms = ?, "
            "shortest_ms = ?, lag1 = ?, late_frames = ?, worst_late_ms = ? WHERE presentation_id = ?"),
        // Inserts no answer if the question is personal, the unit is done or of another session, or the
        // question was answered since the trial was last set aside.
        response(database,
                 "INSERT INTO response (unit_id, attempt, question_id, score, words, response_time_s, "
                 "answered_utc, input) SELECT u.unit_id, ?3, q.question_id, ?5, ?6, ?7, ?8, ?9 "
                 "FROM unit u JOIN session s USING (session_id) JOIN question q USING (protocol_id) "
                 "LEFT JOIN trial t USING (trial_id) WHERE s.session_id = ?1 AND u.unit_id = ?2 "
                 "AND q.code = ?4 AND q.personal = 0 AND u.state = 'planned' AND NOT EXISTS "
                 "(SELECT 1 FROM response r WHERE r.unit_id = u.unit_id AND r.question_id = q.question_id "
                 "AND r.attempt > coalesce(t.set_aside, -1)) RETURNING response_id") {}
  sqlite::Statement frame, event, begin, end, response;
};

}  // namespace study
