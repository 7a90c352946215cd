-- Step 2. Sessions of blocks: pages beside trials, pairs, withdrawal. Runs with foreign keys off and checked
-- afterwards, since SQLite changes a CHECK only by making a table anew.

CREATE TABLE cell (
  protocol_id INTEGER NOT NULL REFERENCES protocol, -- protocol that shows it
  cell INTEGER NOT NULL CHECK (cell >= 0), -- index in the protocol's design
  scene TEXT NOT NULL, -- scene file
  method TEXT NOT NULL, -- LoRes, HiRes, FovFluid, Ours or Ours-TSp
  n_star TEXT NOT NULL, -- n_*, particles when all are coarsest
  mean_fps REAL NOT NULL CHECK (mean_fps >= 0), -- wished mean frame rate; 0: as fast as the method runs, frames/s
  sd_fps REAL NOT NULL CHECK (sd_fps >= 0), -- wished standard deviation of the frame rate, frames/s
  duration_s REAL NOT NULL CHECK (duration_s > 0), -- wished length, s
  PRIMARY KEY (protocol_id, cell)
) STRICT, WITHOUT ROWID;

-- One row for everything that a session goes through, in order.
CREATE TABLE unit (
  unit_id INTEGER PRIMARY KEY, -- row number
  session_id INTEGER NOT NULL REFERENCES session, -- session it belongs to
  position INTEGER NOT NULL CHECK (position >= 0), -- order in the session, from 0
  block TEXT NOT NULL, -- id of its block in the protocol
  kind TEXT NOT NULL, -- kind of the block
  trial_id INTEGER REFERENCES trial, -- trial; empty: a page
  state TEXT NOT NULL CHECK (state IN ('planned', 'done')), -- planned or done
  done_utc TEXT, -- when it was done
  UNIQUE (session_id, position)
) STRICT;

CREATE TABLE trial_2 (
  trial_id INTEGER PRIMARY KEY, -- row number
  session_id INTEGER NOT NULL REFERENCES session, -- session it belongs to
  position INTEGER NOT NULL CHECK (position >= 0), -- order among the session's trials, from 0
  group_index INTEGER NOT NULL CHECK (group_index >= 0), -- order of its group (scene and n_*) in the session, from 0
  first_cell INTEGER NOT NULL CHECK (first_cell >= 0), -- cell shown first
  second_cell INTEGER CHECK (second_cell >= 0), -- cell shown second; empty: no pair
  schedule_seed INTEGER NOT NULL, -- orders the intervals; 64 bits, two's complement
  state TEXT NOT NULL CHECK (state IN ('planned', 'answered')), -- planned or answered
  excluded TEXT, -- reason why the experimenter excluded it; empty: not excluded
  UNIQUE (session_id, position)
) STRICT;

CREATE TABLE presentation_2 (
  presentation_id INTEGER PRIMARY KEY, -- row number
  trial_id INTEGER NOT NULL REFERENCES trial, -- trial shown
  attempt INTEGER NOT NULL CHECK (attempt >= 1), -- 1, and more after an interruption or a repeat
  interval INTEGER NOT NULL CHECK (interval IN (0, 1)), -- 0: first or only stimulus, 1: second of a pair
  cell INTEGER NOT NULL CHECK (cell >= 0), -- cell shown
  state TEXT NOT NULL CHECK (state IN ('running', 'interrupted', 'played')), -- played, or cut short
  started_utc TEXT NOT NULL, -- when it began
  start_ns INTEGER NOT NULL, -- the same on the session's clock, ns
  end_ns INTEGER, -- end of the last frame on the session's clock, ns
  verdict TEXT CHECK (verdict IN ('pass', 'degraded', 'fail')), -- timing verdict; empty: no schedule to judge by
  grade TEXT CHECK (grade IN ('A', 'B', 'C', 'D')), -- evidence: A photodiode, B display, C compositor, D submit
  reason TEXT, -- why it is not a pass
  frames INTEGER, -- frames shown
  mean_fps REAL, -- realised harmonic mean, frames/s
  mean_arithmetic_fps REAL, -- realised arithmetic mean, frames/s
  sd_fps REAL, -- realised population standard deviation, frames/s
  p95_ms REAL, -- 95th percentile of the intervals, ms
  longest_ms REAL, -- longest interval, ms
  shortest_ms REAL, -- shortest interval, ms
  lag1 REAL, -- autocorrelation of the frame rate at lag 1
  late_frames INTEGER, -- frames beyond the protocol's bound
  worst_late_ms REAL, -- largest lateness, ms
  UNIQUE (trial_id, attempt, interval)
) STRICT;

-- Every answer, on pages and after trials. Withdrawal deletes rows; words are free text.
CREATE TABLE response_2 (
  response_id INTEGER PRIMARY KEY, -- row number
  unit_id INTEGER NOT NULL REFERENCES unit, -- page or trial it was asked at
  attempt INTEGER NOT NULL CHECK (attempt >= 0), -- showing of the trial that was judged; 0: a page. The last one counts
  question_id INTEGER NOT NULL REFERENCES question, -- question answered
  score INTEGER, -- answer on the question's scale; empty: left out, or words
  words TEXT, -- free words; empty: none
  response_time_s REAL NOT NULL CHECK (response_time_s >= 0), -- from question to answer, s
  answered_utc TEXT NOT NULL, -- when
  UNIQUE (unit_id, question_id, attempt)
) STRICT;

-- The experimenter's notes: free text, so apart from the log that is never deleted.
CREATE TABLE note (
  note_id INTEGER PRIMARY KEY, -- row number
  session_id INTEGER NOT NULL REFERENCES session, -- session it concerns
  unit_id INTEGER REFERENCES unit, -- page or trial under way; empty: none
  utc TEXT NOT NULL, -- when
  words TEXT NOT NULL -- what was noted
) STRICT;

-- Who withdrew. It wins over data of the same code in every later merge.
CREATE TABLE tombstone (
  participant TEXT PRIMARY KEY, -- participant code
  withdrawn_utc TEXT NOT NULL -- when
) STRICT;

-- What earlier versions wrote: every trial was one stimulus and one answer.
INSERT INTO cell SELECT DISTINCT s.protocol_id, t.setting, '', '', '', t.nominal_mean_fps, t.nominal_sd_fps, t.duration_s
  FROM trial t JOIN session s USING (session_id);
INSERT INTO trial_2 SELECT trial_id, session_id, position, 0, setting, NULL, schedule_seed, state, NULL FROM trial;
INSERT INTO presentation_2 SELECT p.presentation_id, p.trial_id, p.attempt, 0, t.setting, p.state, p.started_utc, p.start_ns,
  p.end_ns, p.verdict, p.grade, p.reason, p.frames, p.mean_fps, p.mean_arithmetic_fps, p.sd_fps, p.p95_ms, p.longest_ms,
  p.shortest_ms, p.lag1, p.late_frames, p.worst_late_ms FROM presentation p JOIN trial t USING (trial_id);
INSERT INTO unit (session_id, position, block, kind, trial_id, state, done_utc)
  SELECT t.session_id, t.position, 'trials', iif(t.practice, 'practice', 'stimulus'), t.trial_id,
  iif(t.state = 'answered', 'done', 'planned'), r.answered_utc FROM trial t LEFT JOIN response r USING (trial_id);
INSERT INTO response_2 SELECT r.response_id, u.unit_id, p.attempt, r.question_id, r.score, NULL, r.response_time_s,
  r.answered_utc FROM response r JOIN unit u USING (trial_id) JOIN presentation p USING (presentation_id);

DROP TABLE response;
DROP TABLE presentation;
DROP TABLE trial;
ALTER TABLE trial_2 RENAME TO trial;
ALTER TABLE presentation_2 RENAME TO presentation;
ALTER TABLE response_2 RENAME TO response;

ALTER TABLE session ADD COLUMN slot INTEGER NOT NULL DEFAULT 0; -- place in the balanced assignment
ALTER TABLE session ADD COLUMN state TEXT NOT NULL DEFAULT 'open'; -- open, done, ended early or dropped out
ALTER TABLE session ADD COLUMN gaze_source TEXT NOT NULL DEFAULT 'none'; -- tracked, mouse, fixed or none
ALTER TABLE session ADD COLUMN station TEXT NOT NULL DEFAULT ''; -- where it was recorded
ALTER TABLE session ADD COLUMN screen_width_mm REAL; -- width of the picture on the screen, mm
ALTER TABLE session ADD COLUMN viewing_distance_mm REAL; -- eye to screen, mm
ALTER TABLE question ADD COLUMN kind TEXT NOT NULL DEFAULT 'scale'; -- scale, choice, number or text
