-- Step 9. Imported studies: the program that recorded a session elsewhere, and its source's hash. What a source
-- may not tell can be empty: when a stimulus was shown and an answer given, how long an answer took, which
-- content a frame showed, and whether it was late.
ALTER TABLE session ADD COLUMN imported_from TEXT /* program that recorded the session elsewhere, as the mapping of vip-study import names it; empty: vip-study recorded it */;
ALTER TABLE session ADD COLUMN source_sha256 TEXT /* SHA-256 of the file from which its answers were imported; empty: not imported */;

PRAGMA legacy_alter_table = ON;
CREATE TABLE presentation_2 (
  presentation_id INTEGER PRIMARY KEY, -- row number
  trial_id INTEGER NOT NULL REFERENCES trial, -- trial shown
  attempt INTEGER NOT NULL CHECK (attempt >= 1), -- 1, and more after an interruption or a repeat
  interval INTEGER NOT NULL CHECK (interval IN (0, 1)), -- 0: first or only stimulus, 1: second of a pair
  cell INTEGER NOT NULL CHECK (cell >= 0), -- cell shown
  state TEXT NOT NULL CHECK (state IN ('running', 'interrupted', 'played')), -- played, or cut short
  started_utc TEXT, -- when it began; empty: imported, and the source does not tell
  start_ns INTEGER, -- the same on the session's clock, ns; empty: imported, and the source does not tell
  end_ns INTEGER, -- end of the last frame on the session's clock, ns
  verdict TEXT CHECK (verdict IN ('pass', 'degraded', 'fail')), -- timing verdict; empty: no schedule to judge by
  grade TEXT CHECK (grade IN ('A', 'B', 'C', 'D')), -- evidence: A photodiode, B display, C compositor, D submit; empty: no frames were recorded
  reason TEXT, -- why it is not a pass
  frames INTEGER, -- frames shown; empty: not recorded
  mean_fps REAL, -- realised harmonic mean, frames/s; of an import without frames: as its source states it; empty: not recorded
  mean_arithmetic_fps REAL, -- realised arithmetic mean, frames/s
  sd_fps REAL, -- realised population standard deviation, frames/s
  p95_ms REAL, -- 95th percentile of the intervals, ms
  longest_ms REAL, -- longest interval, ms
  shortest_ms REAL, -- shortest interval, ms
  lag1 REAL, -- autocorrelation of the frame rate at lag 1
  late_frames INTEGER, -- frames beyond the protocol's bound; empty: not recorded, or imported, without a schedule
  worst_late_ms REAL, -- largest lateness, ms
  framing_id INTEGER REFERENCES framing, -- how the display framed what was shown; empty: nothing was drawn, or an earlier version, which did not write it
  gaze_source TEXT CHECK (gaze_source IN ('tracked', 'head', 'mouse', 'fixed', 'fixation', 'none')), -- what the fluid followed, as in session: head instead of tracked where recording gaze was not allowed; empty: an earlier version, which did not write it
  p99_ms REAL, -- 99th percentile of the intervals, ms; empty: not recorded, or an earlier version, which did not write it
  hitches INTEGER, -- intervals longer than 1.5 times the median interval; empty: as for p99_ms
  animation_error_ms REAL, -- mean absolute difference between the step of the simulated time and the interval of a frame, ms; empty: content followed frames instead of time, imported, or an earlier version
  UNIQUE (trial_id, attempt, interval)
) STRICT;
INSERT INTO presentation_2 SELECT * FROM presentation ORDER BY presentation_id;
DROP TABLE presentation;
ALTER TABLE presentation_2 RENAME TO presentation;
CREATE TABLE response_2 (
  response_id INTEGER PRIMARY KEY, -- row number
  unit_id INTEGER NOT NULL REFERENCES unit, -- page or trial it was asked at
  attempt INTEGER NOT NULL CHECK (attempt >= 0), -- showing of the trial that was judged; 0: a page. The last one counts
  question_id INTEGER NOT NULL REFERENCES question, -- question answered
  score INTEGER, -- answer on the question's scale; empty: left out, or words
  words TEXT, -- free words; empty: none
  response_time_s REAL CHECK (response_time_s >= 0), -- from question to answer, s; empty: imported, and the source does not tell
  answered_utc TEXT, -- when; empty: imported, and the source does not tell
  input TEXT CHECK (input IN ('keyboard', 'mouse', 'gamepad', 'ray', 'stick', 'dwell', 'observer')), -- what the answer was given with, of one left empty the confirmation: ray: a hand's ray and select; stick: a controller's thumbstick; dwell: by looking at it for a while; observer: a simulated participant; empty: not known, or an earlier version, which did not write it
  UNIQUE (unit_id, question_id, attempt)
) STRICT;
INSERT INTO response_2 SELECT * FROM response ORDER BY response_id;
DROP TABLE response;
ALTER TABLE response_2 RENAME TO response;
CREATE TABLE frame_2 (
  presentation_id INTEGER NOT NULL REFERENCES presentation, -- presentation it belongs to
  frame_index INTEGER NOT NULL, -- from 0
  content_step INTEGER, -- step of the fluid shown; empty: imported
  simulation_time_s REAL, -- simulated time of that step, s; empty: imported
  scheduled_ns INTEGER NOT NULL, -- planned onset after start_ns, ns; imported: the onset after the first frame's, as there was no schedule
  submitted_ns INTEGER, -- handed over, after the planned onset, ns
  gpu_done_ns INTEGER, -- drawn, after the planned onset, ns
  predicted_display_ns INTEGER, -- predicted onset after the planned one, ns
  actual_display_ns INTEGER, -- reported onset after the planned one, ns
  late INTEGER CHECK (late IN (0, 1)), -- 1: later than the protocol's bound; empty: imported, without a schedule
  particles TEXT, -- particles by level, finest first, separated by spaces; before schema 4 without the levels that held none; empty: not measured
  active_fraction REAL CHECK (active_fraction BETWEEN 0 AND 1), -- share of particles that the solver solved; empty: not measured, or a method that solves all
  tau_fps REAL, -- tau that the solver went by; empty: not measured, a method without tau, or no frame's time known to it yet, frames/s
  beta REAL CHECK (beta BETWEEN 0 AND 1), -- lowest probability of a particle to be solved that it went by; empty: as for tau_fps
  mu_fps REAL, -- mean frame rate behind tau; empty: tau was given, or as for tau_fps, frames/s
  delta_fps REAL, -- standard deviation of the frame rate behind tau; empty: as for mu_fps, frames/s
  speed_limited INTEGER, -- guard: particle-substeps of this frame whose speed was limited; empty: not measured
  coincident_pairs INTEGER, -- guard: neighbour pairs at zero distance; empty: not measured
  not_finite INTEGER, -- guard: particles whose NaN or infinity was quarantined; empty: not measured
  neighbours_dropped INTEGER, -- guard: neighbours that found no room in a list; empty: not measured
  wall_projected INTEGER, -- guard: particle-substeps pushed back inside a wall; empty: not measured
  nozzle_waited INTEGER, -- guard: layers of water that a nozzle left out; empty: not measured
  saliency_not_finite INTEGER, -- guard: particles whose saliency was not finite; empty: not measured
  gaze_lost INTEGER, -- guard: eyes without a valid gaze; empty: not measured
  PRIMARY KEY (presentation_id, frame_index)
) STRICT, WITHOUT ROWID;
INSERT INTO frame_2 SELECT * FROM frame ORDER BY presentation_id, frame_index;
DROP TABLE frame;
ALTER TABLE frame_2 RENAME TO frame;
PRAGMA legacy_alter_table = OFF;
