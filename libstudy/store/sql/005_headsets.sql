-- Step 5. Adds facts, frame slots and interpupillary distances of headsets, head poses, gaze rays,
-- validations of the eye tracker, and the input device of each answer. legacy_alter_table keeps the tables'
-- names in views and references while the tables are made anew.
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
  gaze_source TEXT NOT NULL CHECK (gaze_source IN ('tracked', 'head', 'mouse', 'fixed', 'fixation', 'none')), -- what was planned: tracked, head: the head's direction stands in for gaze, mouse, fixed: taken to be the middle of the picture, fixation: the protocol prescribes the middle, or none
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
CREATE INDEX session_of_person ON session (person);

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
  gaze_source TEXT CHECK (gaze_source IN ('tracked', 'head', 'mouse', 'fixed', 'fixation', 'none')), -- what the fluid followed, as in session: head instead of tracked where recording gaze was not allowed; empty: an earlier version, which did not write it
  UNIQUE (trial_id, attempt, interval)
) STRICT;
INSERT INTO presentation_2 SELECT *, NULL FROM presentation;
DROP TABLE presentation;
ALTER TABLE presentation_2 RENAME TO presentation;

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
  input TEXT CHECK (input IN ('keyboard', 'mouse', 'gamepad', 'ray', 'stick', 'dwell', 'observer')), -- what the answer was given with, of one left empty the confirmation: ray: a hand's ray and select; stick: a controller's thumbstick; dwell: by looking at it for a while; observer: a simulated participant; empty: not known, or an earlier version, which did not write it
  UNIQUE (unit_id, question_id, attempt)
) STRICT;
INSERT INTO response_2 SELECT *, NULL FROM response;
DROP TABLE response;
ALTER TABLE response_2 RENAME TO response;

-- Gaze samples, one row for each sample that the source delivered. Recorded only if the participant allowed
-- it.
CREATE TABLE gaze_2 (
  presentation_id INTEGER NOT NULL REFERENCES presentation, -- presentation it belongs to
  sample_index INTEGER NOT NULL CHECK (sample_index >= 0), -- from 0
  source TEXT NOT NULL CHECK (source IN ('tracker', 'head', 'mouse')), -- tracker: an eye tracker; head: straight ahead of the head, which is no eye; mouse: the pointer, which people often do not look at
  sampled_ns INTEGER NOT NULL, -- when the sample came, after the presentation's start_ns; of a headset: when the eyes were there where its runtime tells that, else the predicted time of the slot; of a headset and not valid, where no time is told: that time less the greatest age of a sample so far, and not before the last sample, ns
  device_ns INTEGER, -- the device's own time stamp; of a headset: the time of the sample on the session's clock as the runtime tells it; empty: it gives none, ns
  valid INTEGER NOT NULL CHECK (valid IN (0, 1)), -- 1: the source knew where; 0: a blink, or a pointer off the picture
  x REAL, -- from the left edge, as a share of the picture's width; of a headset: on the left eye's picture as it was drawn, with its margin; empty: not known, or black
  y REAL, -- from the top edge, as a share of the picture's height; empty: not known
  tracked INTEGER CHECK (tracked IN (0, 1)), -- 1: of the source's usual quality; 0: sub-nominal, a guess of the runtime (OpenXR's valid without tracked); empty: the source does not tell
  origin_x_m REAL, -- where the ray of gaze begins, in the head's frame (right, up and back of the middle between the eyes): to the right; empty: no ray, m
  origin_y_m REAL, -- likewise up, m
  origin_z_m REAL, -- likewise back, m
  direction_x REAL, -- direction of the ray in the head's frame, a unit vector: right; both eyes' one ray (cyclopean); empty: no ray
  direction_y REAL, -- likewise up
  direction_z REAL, -- likewise back; -1 is straight ahead
  PRIMARY KEY (presentation_id, sample_index)
) STRICT, WITHOUT ROWID;
INSERT INTO gaze_2 SELECT *, NULL, NULL, NULL, NULL, NULL, NULL, NULL FROM gaze;
DROP TABLE gaze;
ALTER TABLE gaze_2 RENAME TO gaze;
PRAGMA legacy_alter_table = OFF;

-- Facts of a session's headset, as its runtime reports them. A session has another row if the facts changed,
-- for example because it was resumed on another headset.
CREATE TABLE headset (
  headset_id INTEGER PRIMARY KEY, -- row number
  session_id INTEGER NOT NULL REFERENCES session, -- session it concerns
  runtime TEXT NOT NULL, -- name of the OpenXR runtime
  runtime_version TEXT NOT NULL, -- its version, as the runtime counts
  headset TEXT NOT NULL, -- name of the headset, as the runtime tells it
  left_width_px INTEGER NOT NULL CHECK (left_width_px > 0), -- width of the left eye's picture, px
  left_height_px INTEGER NOT NULL CHECK (left_height_px > 0), -- likewise its height, px
  right_width_px INTEGER NOT NULL CHECK (right_width_px > 0), -- width of the right eye's picture, px
  right_height_px INTEGER NOT NULL CHECK (right_height_px > 0), -- likewise its height, px
  format TEXT NOT NULL, -- format of the pictures handed over
  refresh_told_hz REAL CHECK (refresh_told_hz > 0), -- refresh rate that the runtime tells; empty: it lists fewer than two, Hz
  refresh_measured_hz REAL CHECK (refresh_measured_hz > 0), -- of settled steps between predicted times: whole periods over the time that they took; empty: not measured, Hz
  left_fov_left_deg REAL NOT NULL, -- field of view of the left eye from straight ahead to its left edge, negative to the left, degrees
  left_fov_right_deg REAL NOT NULL, -- likewise to its right edge, degrees
  left_fov_up_deg REAL NOT NULL, -- likewise to its upper edge, degrees
  left_fov_down_deg REAL NOT NULL, -- likewise to its lower edge, negative downwards, degrees
  right_fov_left_deg REAL NOT NULL, -- field of view of the right eye: left edge, degrees
  right_fov_right_deg REAL NOT NULL, -- likewise right edge, degrees
  right_fov_up_deg REAL NOT NULL, -- likewise upper edge, degrees
  right_fov_down_deg REAL NOT NULL, -- likewise lower edge, degrees
  hold TEXT NOT NULL CHECK (hold IN ('image', 'state', 'head_locked')), -- what is seen between two frames: image: the old picture at its own pose; state: the frozen fluid drawn from the new pose; head_locked: the old picture at the new pose
  blend TEXT NOT NULL, -- environment blend mode; opaque hides the world
  times_convert INTEGER NOT NULL CHECK (times_convert IN (0, 1)), -- 1: the runtime's times convert to the system's clock
  position_tracking INTEGER NOT NULL CHECK (position_tracking IN (0, 1)), -- 1: the runtime says that the head's place is followed
  eye_tracking INTEGER NOT NULL CHECK (eye_tracking IN (0, 1)) -- 1: an eye tracker was asked for and is served
) STRICT;
CREATE INDEX headset_of_session ON headset (session_id);

-- Interpupillary distance for which the headset's pictures are drawn: one row at the start of a session, and
-- one after each change by more than 0.2 mm.
CREATE TABLE ipd (
  ipd_id INTEGER PRIMARY KEY, -- row number
  session_id INTEGER NOT NULL REFERENCES session, -- session it concerns
  clock_ns INTEGER NOT NULL, -- when, on the session's clock, ns
  ipd_mm REAL NOT NULL CHECK (ipd_mm > 0) -- interpupillary distance, mm
) STRICT;
CREATE INDEX ipd_of_session ON ipd (session_id);

-- Frame slots of a headset during a presentation. A slot is a period of the headset's compositor.
CREATE TABLE slot (
  presentation_id INTEGER NOT NULL REFERENCES presentation, -- presentation it belongs to
  slot_index INTEGER NOT NULL CHECK (slot_index >= 0), -- from 0
  predicted_ns INTEGER NOT NULL, -- when it was to be seen as the runtime predicted, after the presentation's start_ns, ns
  period_ns INTEGER NOT NULL, -- predicted period as the runtime told it with the slot, ns
  should_render INTEGER NOT NULL CHECK (should_render IN (0, 1)), -- 0: nothing of it would be seen
  frame_index INTEGER, -- frame that was on, as in frame; empty: black
  PRIMARY KEY (presentation_id, slot_index)
) STRICT, WITHOUT ROWID;

-- Predicted pose of the head in each slot, in OpenXR's LOCAL space (x right, y up, z back). Motion can
-- identify a person, so poses are recorded only if the participant allowed recording gaze.
CREATE TABLE head (
  presentation_id INTEGER NOT NULL REFERENCES presentation, -- presentation it belongs to
  slot_index INTEGER NOT NULL CHECK (slot_index >= 0), -- slot, as in slot
  x_m REAL, -- place of the middle between the eyes, right; empty: not valid, m
  y_m REAL, -- likewise up, m
  z_m REAL, -- likewise back, m
  quat_x REAL, -- turn, a unit quaternion; empty: not valid
  quat_y REAL, -- likewise
  quat_z REAL, -- likewise
  quat_w REAL, -- likewise
  place_tracked INTEGER NOT NULL CHECK (place_tracked IN (0, 1)), -- 1: the place was measured; 0: a guess, or not valid
  turn_tracked INTEGER NOT NULL CHECK (turn_tracked IN (0, 1)), -- 1: the turn was measured; 0: a guess, or not valid
  PRIMARY KEY (presentation_id, slot_index)
) STRICT, WITHOUT ROWID;

-- Accuracy and precision of the eye tracker at each target of each validation, one row for each target.
-- Recorded only if the participant allowed recording gaze.
CREATE TABLE gaze_validation (
  session_id INTEGER NOT NULL REFERENCES session, -- session it concerns
  validation INTEGER NOT NULL CHECK (validation >= 1), -- order of validations in the session, from 1
  point INTEGER NOT NULL CHECK (point >= 0), -- order of points in the validation, from 0
  clock_ns INTEGER NOT NULL, -- when the samples of the point began, on the session's clock, ns
  azimuth_deg REAL NOT NULL, -- where the target was, from the middle of the grid to the right, degrees
  elevation_deg REAL NOT NULL, -- likewise up, degrees
  samples INTEGER NOT NULL CHECK (samples >= 0), -- samples taken
  valid INTEGER NOT NULL CHECK (valid BETWEEN 0 AND samples), -- those of them that were valid
  accuracy_deg REAL, -- angle between the mean direction of the valid samples and the target's; empty: none was valid, degrees
  sd_deg REAL, -- precision: root mean square of the angles between the valid samples and their mean direction; empty: likewise, degrees
  rms_s2s_deg REAL, -- precision: root mean square of the angles between successive valid samples; empty: fewer than two, degrees
  passed INTEGER NOT NULL CHECK (passed IN (0, 1)), -- 1: the validation kept to the protocol's threshold
  PRIMARY KEY (session_id, validation, point)
) STRICT, WITHOUT ROWID;
