-- Step 2. Adds blocks with pages besides trials, pairs of stimuli, withdrawal and merging. Tables are made
-- anew: SQLite has no other way to change a CHECK and to keep the comments of new columns. Meanwhile foreign
-- keys are switched off; the program checks them at the end of the step.

CREATE TABLE question_2 (
  question_id INTEGER PRIMARY KEY, -- row number
  protocol_id INTEGER NOT NULL REFERENCES protocol, -- protocol that asks it
  code TEXT NOT NULL, -- id in the protocol file
  wording TEXT NOT NULL, -- exact wording
  language TEXT NOT NULL, -- language of the wording
  kind TEXT NOT NULL CHECK (kind IN ('scale', 'choice', 'number', 'text')), -- scale, choice, number or text
  scale_min INTEGER NOT NULL, -- lowest score; of no meaning for text
  scale_max INTEGER NOT NULL CHECK (scale_max >= scale_min), -- highest score
  anchors TEXT NOT NULL, -- one line "score = words" for each labelled score
  personal INTEGER NOT NULL CHECK (personal IN (0, 1)), -- 1: answers stand in the file of personal data alone
  UNIQUE (protocol_id, code)
) STRICT;

-- The questions that each block asks.
CREATE TABLE ask (
  protocol_id INTEGER NOT NULL REFERENCES protocol, -- protocol
  block TEXT NOT NULL, -- id of the block
  place INTEGER NOT NULL CHECK (place >= 0), -- order among the questions of the block, from 0
  question_id INTEGER NOT NULL REFERENCES question, -- question asked
  PRIMARY KEY (protocol_id, block, place)
) STRICT, WITHOUT ROWID;

CREATE TABLE run_2 (
  run_id INTEGER PRIMARY KEY, -- row number
  uid TEXT NOT NULL UNIQUE, -- recognises the run in copies of the database
  started_utc TEXT NOT NULL, -- when the command was given
  program_version TEXT NOT NULL, -- version of the program
  options TEXT NOT NULL -- options of the command, from which resume rebuilds everything
) STRICT;

-- If people at different stations have the same participant code, a merge gives them different codes in the
-- column participant. The columns uid, person and code never change.
CREATE TABLE session_2 (
  session_id INTEGER PRIMARY KEY, -- row number
  uid TEXT NOT NULL UNIQUE, -- recognises the session in copies of the database
  run_id INTEGER NOT NULL REFERENCES run, -- command that planned it
  protocol_id INTEGER NOT NULL REFERENCES protocol, -- protocol followed
  participant TEXT NOT NULL CHECK (length(participant) BETWEEN 1 AND 32
    AND participant NOT GLOB '*[^A-Za-z0-9_-]*'), -- participant code, never a name
  person TEXT NOT NULL, -- recognises the participant in copies of the database
  code TEXT NOT NULL, -- participant code as given at the station
  visit INTEGER NOT NULL CHECK (visit >= 1), -- visit of this participant under this protocol
  seed INTEGER NOT NULL, -- seed of plan and schedules
  slot INTEGER NOT NULL CHECK (slot >= 0), -- place in the balanced assignment
  state TEXT NOT NULL CHECK (state IN ('open', 'done', 'not eligible', 'stopped', 'dropped out')), -- open, done, or how it ended early
  test_data INTEGER NOT NULL CHECK (test_data IN (0, 1)), -- 1: overridden or marked as a test, never pooled with real data
  observer TEXT, -- simulated observer that answered; empty: a person
  clock TEXT NOT NULL CHECK (clock IN ('real', 'virtual')), -- real or virtual clock
  display TEXT NOT NULL, -- where frames were shown
  refresh_hz REAL CHECK (refresh_hz > 0), -- fixed refresh rate of the display; empty: none or not known, Hz
  stimulus TEXT NOT NULL, -- what was shown
  machine TEXT NOT NULL, -- operating system, processor, cores
  station TEXT NOT NULL, -- where it was recorded
  time_zone TEXT NOT NULL, -- time zone of the station
  gaze_source TEXT NOT NULL CHECK (gaze_source IN ('tracked', 'mouse', 'fixed', 'none')), -- tracked, mouse, fixed or none
  screen_width_mm REAL CHECK (screen_width_mm > 0), -- width of the picture on the screen, mm
  viewing_distance_mm REAL CHECK (viewing_distance_mm > 0), -- eye to screen, mm
  ptpe TEXT, -- PTPE file in force, in full; empty: none
  started_utc TEXT, -- first trial began
  ended_utc TEXT, -- last unit done, or ended early
  UNIQUE (participant, protocol_id, visit)
) STRICT;

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

-- One row for each unit of a session, that is each trial and each page.
CREATE TABLE unit (
  unit_id INTEGER PRIMARY KEY, -- row number
  session_id INTEGER NOT NULL REFERENCES session, -- session it belongs to
  position INTEGER NOT NULL CHECK (position >= 0), -- order in the session, from 0
  block TEXT NOT NULL, -- id of its block in the protocol
  block_index INTEGER NOT NULL CHECK (block_index >= 0), -- index of its block in the protocol, from 0
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
  set_aside INTEGER NOT NULL CHECK (set_aside >= 0), -- showings up to this one were set aside, so that it is shown again; 0: none
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

-- All answers, given on pages and after trials. A withdrawal deletes the person's rows. The column words
-- contains free text.
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

-- The experimenter's notes. They are free text, so they are not in the event log.
CREATE TABLE note (
  note_id INTEGER PRIMARY KEY, -- row number
  session_id INTEGER NOT NULL REFERENCES session, -- session it concerns
  unit_id INTEGER REFERENCES unit, -- page or trial under way; empty: none
  utc TEXT NOT NULL, -- when
  words TEXT NOT NULL -- what was noted
) STRICT;

-- People who withdrew. These rows are all that stays of them. A merge deletes all data of a person who has a
-- row here.
CREATE TABLE tombstone (
  person TEXT PRIMARY KEY, -- recognises the participant in copies of the database
  participant TEXT NOT NULL UNIQUE, -- participant code
  code TEXT NOT NULL, -- participant code as given at the station
  station TEXT NOT NULL, -- station of the first session
  withdrawn_utc TEXT NOT NULL -- when
) STRICT;

-- Converts the rows of earlier versions, in which every trial had one stimulus and one answer. The uids are
-- made from values of the rows, so that copies of one database get the same uids.
INSERT INTO question_2 SELECT question_id, protocol_id, code, wording, language, 'scale', scale_min, scale_max, anchors, 0
  FROM question;
INSERT INTO ask SELECT protocol_id, 'trials', row_number() OVER (PARTITION BY protocol_id ORDER BY question_id) - 1, question_id
  FROM question;
INSERT INTO run_2 SELECT run_id, format('1/%d/%s/%s', run_id, started_utc, (SELECT substr(p.sha256, 1, 12) || '/' || s.seed
  FROM session s JOIN protocol p USING (protocol_id) WHERE s.run_id = run.run_id ORDER BY session_id LIMIT 1)), started_utc,
  program_version, options FROM run;
INSERT INTO session_2 SELECT s.session_id, format('%s/%d/%s', r.uid, s.session_id, s.participant), s.run_id, s.protocol_id,
  s.participant, (SELECT format('%s/%d/%s', q.uid, f.session_id, f.participant) FROM session f JOIN run_2 q USING (run_id)
    WHERE f.participant = s.participant ORDER BY f.session_id LIMIT 1),
  s.participant, s.visit, s.seed, 0, iif(s.ended_utc IS NULL, 'open', 'done'), s.test_data, s.observer, s.clock, s.display, NULL,
  s.stimulus, s.machine, '', s.time_zone, 'none', NULL, NULL, s.ptpe, s.started_utc, s.ended_utc
  FROM session s JOIN run_2 r USING (run_id);
INSERT INTO cell SELECT DISTINCT s.protocol_id, t.setting, '', '', '', t.nominal_mean_fps, t.nominal_sd_fps, t.duration_s
  FROM trial t JOIN session s USING (session_id);
INSERT INTO trial_2 SELECT trial_id, session_id, position, 0, setting, NULL, schedule_seed, state, 0, NULL FROM trial;
INSERT INTO presentation_2 SELECT p.presentation_id, p.trial_id, p.attempt, 0, t.setting, p.state, p.started_utc, p.start_ns,
  p.end_ns, p.verdict, p.grade, p.reason, p.frames, p.mean_fps, p.mean_arithmetic_fps, p.sd_fps, p.p95_ms, p.longest_ms,
  p.shortest_ms, p.lag1, p.late_frames, p.worst_late_ms FROM presentation p JOIN trial t USING (trial_id);
INSERT INTO unit (session_id, position, block, block_index, kind, trial_id, state, done_utc)
  SELECT t.session_id, t.position, 'trials', 0, iif(t.practice, 'practice', 'stimulus'), t.trial_id,
  iif(t.state = 'answered', 'done', 'planned'), (SELECT max(r.answered_utc) FROM response r WHERE r.trial_id = t.trial_id)
  FROM trial t ORDER BY t.trial_id;
INSERT INTO response_2 SELECT r.response_id, u.unit_id, p.attempt, r.question_id, r.score, NULL, r.response_time_s,
  r.answered_utc FROM response r JOIN unit u USING (trial_id) JOIN presentation p USING (presentation_id);

DROP TABLE response;
DROP TABLE presentation;
DROP TABLE trial;
DROP TABLE session;
DROP TABLE run;
DROP TABLE question;
ALTER TABLE question_2 RENAME TO question;
ALTER TABLE run_2 RENAME TO run;
ALTER TABLE session_2 RENAME TO session;
ALTER TABLE trial_2 RENAME TO trial;
ALTER TABLE presentation_2 RENAME TO presentation;
ALTER TABLE response_2 RENAME TO response;

CREATE INDEX session_of_person ON session (person);
CREATE INDEX unit_of_trial ON unit (trial_id);

-- Permits deleting the events of people who withdrew, but no other events.
DROP TRIGGER event_is_kept;
CREATE TRIGGER event_is_kept BEFORE DELETE ON event
  WHEN NOT EXISTS (SELECT 1 FROM session s JOIN tombstone t USING (person) WHERE s.session_id = OLD.session_id)
  BEGIN SELECT RAISE(ABORT, 'the event log is append-only'); END;
