-- Step 4. Adds views that define which answers and showings count, the solver's own values for each frame,
-- and the framing of scenes on displays.

-- One row for each question about each trial, with the last answer about a showing that was not set aside.
-- attempt: the showing that the answer judges; without an answer, the last showing that was played and not
-- set aside; empty: there is none. why_not: why the answer does not count; empty: it counts. The plan of an
-- analysis may omit further answers (timing, straight-lining, test data).
CREATE VIEW judgement AS
  SELECT unit_id, trial_id, question_id, place, response_id, attempt, answered, why_not, why_not IS NULL AS counts FROM (
    SELECT u.unit_id, t.trial_id, k.question_id, k.place, r.response_id,
      r.score IS NOT NULL OR r.words IS NOT NULL AS answered,
      coalesce(r.attempt, (SELECT max(p.attempt) FROM presentation p
        WHERE p.trial_id = t.trial_id AND p.state = 'played' AND p.attempt > t.set_aside)) AS attempt,
      CASE WHEN t.excluded IS NOT NULL THEN 'excluded'
        WHEN r.score IS NULL AND r.words IS NULL THEN 'not answered'
        WHEN u.kind = 'practice' THEN 'practice' END AS why_not
    FROM trial t JOIN unit u USING (trial_id) JOIN session s ON s.session_id = t.session_id
      JOIN ask k ON k.protocol_id = s.protocol_id AND k.block = u.block
      LEFT JOIN response r ON r.response_id = (SELECT l.response_id FROM response l WHERE l.unit_id = u.unit_id
        AND l.question_id = k.question_id AND l.attempt > t.set_aside ORDER BY l.attempt DESC LIMIT 1));

-- The showing that represents each trial: the first showing with an answer, because after an interruption a
-- trial may have answers about several showings. Without an answer, the last showing that was played and not
-- set aside.
CREATE VIEW trial_showing AS
  SELECT trial_id, coalesce(min(attempt) FILTER (WHERE answered), max(attempt)) AS attempt FROM judgement GROUP BY trial_id;

-- All showings. judged: 1 if an answer in the view judgement is about the showing. counts: 1 if such an
-- answer counts.
CREATE VIEW showing AS
  SELECT presentation_id, trial_id, attempt, interval, judged, why_not, why_not IS NULL AS counts FROM (
    SELECT p.presentation_id, p.trial_id, p.attempt, p.interval, j.trial_id IS NOT NULL AS judged,
      CASE WHEN j.trial_id IS NOT NULL THEN j.why_not
        WHEN p.attempt <= t.set_aside THEN 'set aside'
        WHEN p.state <> 'played' THEN 'cut short'
        WHEN t.excluded IS NOT NULL THEN 'excluded'
        WHEN EXISTS (SELECT 1 FROM presentation l WHERE l.trial_id = p.trial_id AND l.attempt > p.attempt) THEN 'shown again'
        ELSE 'not answered' END AS why_not
    FROM presentation p JOIN trial t USING (trial_id)
      LEFT JOIN (SELECT trial_id, attempt, min(why_not) AS why_not FROM judgement WHERE answered GROUP BY trial_id, attempt) j
        ON j.trial_id = p.trial_id AND j.attempt = p.attempt);

-- All answers, given on pages and after trials. counts: 1 if the answer was given on a page, or is in the
-- view judgement and counts there.
CREATE VIEW answer AS
  SELECT response_id, why_not, why_not IS NULL AS counts FROM (
    SELECT r.response_id, CASE WHEN u.trial_id IS NULL THEN NULL
      WHEN r.attempt <= t.set_aside THEN 'set aside'
      WHEN j.response_id IS NULL THEN 'answered again' ELSE j.why_not END AS why_not
    FROM response r JOIN unit u USING (unit_id) LEFT JOIN trial t USING (trial_id)
      LEFT JOIN judgement j ON j.unit_id = r.unit_id AND j.question_id = r.question_id AND j.response_id = r.response_id);

-- Earlier versions always wrote 1 as the fraction of particles solved, and for tau an estimate from the
-- intervals shown. The solver measured neither value, so both are dropped here. The estimate of tau can still
-- be computed from the frames' onsets.
CREATE TABLE frame_2 (
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
INSERT INTO frame_2 (presentation_id, frame_index, content_step, simulation_time_s, scheduled_ns, submitted_ns, gpu_done_ns,
    predicted_display_ns, actual_display_ns, late, particles)
  SELECT presentation_id, frame_index, content_step, simulation_time_s, scheduled_ns, submitted_ns, gpu_done_ns,
    predicted_display_ns, actual_display_ns, late, nullif(particles, '') FROM frame;
DROP TABLE frame;
ALTER TABLE frame_2 RENAME TO frame;

-- Fraction of particles solved and tau in each showing: means over the frames in which they were measured.
-- The view has subqueries instead of GROUP BY, with which SQLite would read the frames of all showings for
-- each showing that a query selects.
CREATE VIEW solving AS
  SELECT presentation_id,
    (SELECT avg(active_fraction) FROM frame f WHERE f.presentation_id = p.presentation_id) AS active_fraction,
    (SELECT avg(tau_fps) FROM frame f WHERE f.presentation_id = p.presentation_id) AS tau_fps
  FROM presentation p;

-- Adds the state 'refused' for a session without consent. legacy_alter_table keeps the table's name in views
-- and references while the table is made anew.
PRAGMA legacy_alter_table = ON;
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
  state TEXT NOT NULL CHECK (state IN ('open', 'done', 'refused', 'not eligible', 'stopped', 'dropped out')), -- open, done, or how it ended early
  test_data INTEGER NOT NULL CHECK (test_data IN (0, 1)), -- 1: overridden or marked as a test, never pooled with real data
  observer TEXT, -- simulated observer that answered; empty: a person
  clock TEXT NOT NULL CHECK (clock IN ('real', 'virtual')), -- real or virtual clock
  display TEXT NOT NULL, -- where frames were shown
  refresh_hz REAL CHECK (refresh_hz > 0), -- fixed refresh rate of the display; empty: none or not known, Hz
  stimulus TEXT NOT NULL, -- what was shown
  machine TEXT NOT NULL, -- operating system, processor, cores
  station TEXT NOT NULL, -- where it was recorded
  time_zone TEXT NOT NULL, -- time zone of the station
  gaze_source TEXT NOT NULL CHECK (gaze_source IN ('tracked', 'mouse', 'fixed', 'fixation', 'none')), -- tracked, mouse, fixed: taken to be the middle of the picture, fixation: the protocol prescribes the middle, or none
  screen_width_mm REAL CHECK (screen_width_mm > 0), -- width of the picture on the screen, mm
  viewing_distance_mm REAL CHECK (viewing_distance_mm > 0), -- eye to screen, mm
  ptpe TEXT, -- PTPE file in force, in full; empty: none
  started_utc TEXT, -- first trial began
  ended_utc TEXT, -- last unit done, or ended early
  UNIQUE (participant, protocol_id, visit)
) STRICT;
INSERT INTO session_2 SELECT * FROM session;
DROP TABLE session;
ALTER TABLE session_2 RENAME TO session;
PRAGMA legacy_alter_table = OFF;
UPDATE session SET state = 'refused' WHERE state = 'not eligible' AND EXISTS (SELECT 1 FROM note n JOIN unit u USING (session_id)
  WHERE n.session_id = session.session_id AND u.kind = 'consent' AND n.words = 'block ' || u.block);
CREATE INDEX session_of_person ON session (person);

-- How the display of each session framed each scene: one row for all cells of the scene with the same framing
-- and renderer. If a scene has rows with different cells, participants compared pictures that differ. A later
-- row with the same cells is about the display on which the session was resumed. No row: nothing was drawn,
-- or an earlier version recorded the session.
CREATE TABLE framing (
  framing_id INTEGER PRIMARY KEY, -- row number
  session_id INTEGER NOT NULL REFERENCES session, -- session it concerns
  scene TEXT NOT NULL, -- scene file, as in cell
  width_px INTEGER NOT NULL CHECK (width_px > 0), -- width of the picture as it is drawn, px
  height_px INTEGER NOT NULL CHECK (height_px > 0), -- its height, px
  shown_width_px INTEGER NOT NULL CHECK (shown_width_px > 0), -- width of the picture on the display; another where a bake's pictures are scaled, px
  shown_height_px INTEGER NOT NULL CHECK (shown_height_px > 0), -- likewise its height, px
  camera_angle_deg REAL NOT NULL CHECK (camera_angle_deg > 0 AND camera_angle_deg < 180), -- vertical angle of the camera, degrees
  visual_angle_deg REAL CHECK (visual_angle_deg > 0 AND visual_angle_deg < 180), -- vertical angle that the picture fills of the eye's view, in which eccentricity is taken; empty: not known, then it is taken in the camera's, degrees
  angle_ratio REAL CHECK (angle_ratio > 0), -- visual_angle_deg by camera_angle_deg; empty: not known
  cells TEXT NOT NULL, -- cells shown so, separated by spaces
  copied TEXT, -- those of them whose pictures are copied from a bake, separated by spaces; the others are drawn in the session, from live fluid or a bake's particles; empty: all are drawn
  renderer TEXT -- what draws or drew them; empty: not known
) STRICT;
CREATE INDEX framing_of_scene ON framing (session_id, scene);

-- Adds to each presentation a reference to its framing.
PRAGMA legacy_alter_table = ON;
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
  framing_id INTEGER REFERENCES framing, -- how the display framed what was shown; empty: nothing was drawn, or an earlier version, which did not write it
  UNIQUE (trial_id, attempt, interval)
) STRICT;
INSERT INTO presentation_2 SELECT *, NULL FROM presentation;
DROP TABLE presentation;
ALTER TABLE presentation_2 RENAME TO presentation;
PRAGMA legacy_alter_table = OFF;
