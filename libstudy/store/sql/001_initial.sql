-- Step 1. Each column has a comment at the end of its line. Exports make the data dictionary of these
-- comments.

CREATE TABLE protocol (
  protocol_id INTEGER PRIMARY KEY, -- row number
  sha256 TEXT NOT NULL UNIQUE CHECK (length(sha256) = 64), -- SHA-256 of the file and of what overrode it
  name TEXT NOT NULL, -- name in the protocol file
  version TEXT NOT NULL, -- version in the protocol file
  text TEXT NOT NULL, -- the protocol file as read
  trial_seconds REAL CHECK (trial_seconds > 0), -- length of every trial when the command line overrode it, s
  test_data INTEGER NOT NULL CHECK (test_data IN (0, 1)) -- 1: overridden, never pooled with real data
) STRICT;

CREATE TABLE question (
  question_id INTEGER PRIMARY KEY, -- row number
  protocol_id INTEGER NOT NULL REFERENCES protocol, -- protocol that asks it
  code TEXT NOT NULL, -- id in the protocol file
  wording TEXT NOT NULL, -- exact wording
  language TEXT NOT NULL, -- language of the wording
  scale_min INTEGER NOT NULL, -- lowest score
  scale_max INTEGER NOT NULL CHECK (scale_max > scale_min), -- highest score
  anchors TEXT NOT NULL, -- one line "score = words" for each labelled score
  UNIQUE (protocol_id, code)
) STRICT;

CREATE TABLE run (
  run_id INTEGER PRIMARY KEY, -- row number
  started_utc TEXT NOT NULL, -- when the command was given
  program_version TEXT NOT NULL, -- version of the program
  options TEXT NOT NULL -- options of the command, from which resume rebuilds everything
) STRICT;

CREATE TABLE session (
  session_id INTEGER PRIMARY KEY, -- row number
  run_id INTEGER NOT NULL REFERENCES run, -- command that planned it
  protocol_id INTEGER NOT NULL REFERENCES protocol, -- protocol followed
  participant TEXT NOT NULL CHECK (length(participant) BETWEEN 1 AND 32
    AND participant NOT GLOB '*[^A-Za-z0-9_-]*'), -- participant code, never a name
  visit INTEGER NOT NULL CHECK (visit >= 1), -- visit of this participant under this protocol
  seed INTEGER NOT NULL, -- seed of plan and schedules
  test_data INTEGER NOT NULL CHECK (test_data IN (0, 1)), -- 1: overridden or marked as a test, never pooled with real data
  observer TEXT, -- simulated observer that answered; empty: a person
  clock TEXT NOT NULL CHECK (clock IN ('real', 'virtual')), -- real or virtual clock
  display TEXT NOT NULL, -- where frames were shown
  stimulus TEXT NOT NULL, -- what was shown
  machine TEXT NOT NULL, -- operating system, processor, cores
  time_zone TEXT NOT NULL, -- time zone of the station
  ptpe TEXT, -- PTPE file in force, in full; empty: none
  started_utc TEXT, -- first trial began
  ended_utc TEXT, -- last answer given
  UNIQUE (participant, protocol_id, visit)
) STRICT;

CREATE TABLE trial (
  trial_id INTEGER PRIMARY KEY, -- row number
  session_id INTEGER NOT NULL REFERENCES session, -- session it belongs to
  position INTEGER NOT NULL CHECK (position >= 0), -- order of presentation, from 0
  setting INTEGER NOT NULL CHECK (setting >= 0), -- index of the setting in the protocol
  practice INTEGER NOT NULL CHECK (practice IN (0, 1)), -- 1: practice
  nominal_mean_fps REAL NOT NULL CHECK (nominal_mean_fps > 0), -- wished mean frame rate, frames/s
  nominal_sd_fps REAL NOT NULL CHECK (nominal_sd_fps >= 0), -- wished standard deviation, frames/s
  duration_s REAL NOT NULL CHECK (duration_s > 0), -- wished length, s
  schedule_seed INTEGER NOT NULL, -- orders the intervals; 64 bits, two's complement
  state TEXT NOT NULL CHECK (state IN ('planned', 'answered')), -- planned or answered
  UNIQUE (session_id, position)
) STRICT;

CREATE TABLE presentation (
  presentation_id INTEGER PRIMARY KEY, -- row number
  trial_id INTEGER NOT NULL REFERENCES trial, -- trial shown
  attempt INTEGER NOT NULL CHECK (attempt >= 1), -- 1, and more after an interruption
  state TEXT NOT NULL CHECK (state IN ('running', 'interrupted', 'played')), -- played, or cut short
  started_utc TEXT NOT NULL, -- when it began
  start_ns INTEGER NOT NULL, -- the same on the session's clock, ns
  end_ns INTEGER, -- end of the last frame on the session's clock, ns
  verdict TEXT CHECK (verdict IN ('pass', 'degraded', 'fail')), -- timing verdict
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
  UNIQUE (trial_id, attempt)
) STRICT;

-- Times are stored as differences, which take half as many bytes as the clock's full numbers.
CREATE TABLE frame (
  presentation_id INTEGER NOT NULL REFERENCES presentation, -- presentation it belongs to
  frame_index INTEGER NOT NULL, -- from 0
  content_step INTEGER NOT NULL, -- step of the fluid shown
  simulation_time_s REAL NOT NULL, -- simulated time of that step, s
  scheduled_ns INTEGER NOT NULL, -- planned onset after start_ns, ns
  submitted_ns INTEGER, -- handed over, after the planned onset, ns
  gpu_done_ns INTEGER, -- drawn, after the planned onset, ns
  predicted_display_ns INTEGER, -- predicted onset after the planned one, ns
  actual_display_ns INTEGER, -- reported onset after the planned one, ns
  late INTEGER NOT NULL CHECK (late IN (0, 1)), -- 1: later than the protocol's bound
  particles TEXT, -- particles by level as the stimulus lists its levels, separated by spaces
  active_fraction REAL NOT NULL, -- share of particles solved
  tolerance_fps REAL NOT NULL, -- tau under the PTPE file in force, of the 30 intervals before; 0: none, frames/s
  PRIMARY KEY (presentation_id, frame_index)
) STRICT, WITHOUT ROWID;

CREATE TABLE response (
  response_id INTEGER PRIMARY KEY, -- row number
  trial_id INTEGER NOT NULL REFERENCES trial, -- trial judged
  presentation_id INTEGER NOT NULL REFERENCES presentation, -- showing that was judged
  question_id INTEGER NOT NULL REFERENCES question, -- question answered
  score INTEGER NOT NULL, -- answer on the question's scale
  response_time_s REAL NOT NULL CHECK (response_time_s >= 0), -- from question to answer, s
  answered_utc TEXT NOT NULL, -- when
  UNIQUE (trial_id, question_id)
) STRICT;

-- The event log: rows are added, never changed or deleted. It contains neither answers nor free text.
CREATE TABLE event (
  event_id INTEGER PRIMARY KEY, -- order of events
  session_id INTEGER REFERENCES session, -- session it concerns
  presentation_id INTEGER REFERENCES presentation, -- presentation it concerns
  utc TEXT NOT NULL, -- when
  clock_ns INTEGER, -- the same on the session's clock, ns
  kind TEXT NOT NULL, -- what happened
  detail TEXT NOT NULL -- machine, display or program version where it matters
) STRICT;
CREATE INDEX event_of_session ON event (session_id);
CREATE TRIGGER event_is_kept BEFORE DELETE ON event BEGIN SELECT RAISE(ABORT, 'the event log is append-only'); END;
CREATE TRIGGER event_is_final BEFORE UPDATE ON event BEGIN SELECT RAISE(ABORT, 'the event log is append-only'); END;
