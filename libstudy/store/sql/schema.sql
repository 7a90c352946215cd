-- The complete schema of this version, from which new databases are made. The numbered steps upgrade older
-- databases and give the same schema word for word (a test compares them). A new step changes this file too.

CREATE TABLE protocol (
  protocol_id INTEGER PRIMARY KEY, -- row number
  sha256 TEXT NOT NULL UNIQUE CHECK (length(sha256) = 64), -- SHA-256 of the file and of what overrode it
  name TEXT NOT NULL, -- name in the protocol file
  version TEXT NOT NULL, -- version in the protocol file
  text TEXT NOT NULL, -- the protocol file as read
  trial_seconds REAL CHECK (trial_seconds > 0), -- length of every trial when the command line overrode it, s
  test_data INTEGER NOT NULL CHECK (test_data IN (0, 1)) -- 1: overridden, never pooled with real data
) STRICT;

CREATE TABLE event (
  event_id INTEGER PRIMARY KEY, -- order of events
  session_id INTEGER REFERENCES session, -- session it concerns
  presentation_id INTEGER REFERENCES presentation, -- presentation it concerns
  utc TEXT NOT NULL, -- when
  clock_ns INTEGER, -- the same on the session's clock, ns
  kind TEXT NOT NULL, -- what happened
  detail TEXT NOT NULL -- machine, display or program version where it matters
) STRICT;

CREATE TABLE "question" (
  question_id INTEGER PRIMARY KEY, -- row number
  protocol_id INTEGER NOT NULL REFERENCES protocol, -- protocol that asks it
  code TEXT NOT NULL, -- id in the protocol file
  wording TEXT NOT NULL, -- exact wording
  language TEXT NOT NULL, -- language of the wording
  kind TEXT NOT NULL, -- kind of answer, as in the protocol file, such as scale; yes_no is stored as choice
  scale_min INTEGER NOT NULL, -- lowest score; of no meaning for text
  scale_max INTEGER NOT NULL CHECK (scale_max >= scale_min), -- highest score
  anchors TEXT NOT NULL, -- one line "score = words" for each labelled score
  personal INTEGER NOT NULL CHECK (personal IN (0, 1)), -- 1: answers stand in the file of personal data alone
  UNIQUE (protocol_id, code)
) STRICT;

CREATE TABLE ask (
  protocol_id INTEGER NOT NULL REFERENCES protocol, -- protocol
  block TEXT NOT NULL, -- id of the block
  place INTEGER NOT NULL CHECK (place >= 0), -- order among the questions of the block, from 0
  question_id INTEGER NOT NULL REFERENCES question, -- question asked
  PRIMARY KEY (protocol_id, block, place)
) STRICT, WITHOUT ROWID;

CREATE TABLE "run" (
  run_id INTEGER PRIMARY KEY, -- row number
  uid TEXT NOT NULL UNIQUE, -- recognises the run in copies of the database
  started_utc TEXT NOT NULL, -- when the command was given
  program_version TEXT NOT NULL, -- version of the program
  options TEXT NOT NULL -- options of the command, from which resume rebuilds everything
) STRICT;

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

CREATE TABLE "trial" (
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

CREATE TABLE note (
  note_id INTEGER PRIMARY KEY, -- row number
  session_id INTEGER NOT NULL REFERENCES session, -- session it concerns
  unit_id INTEGER REFERENCES unit, -- page or trial under way; empty: none
  utc TEXT NOT NULL, -- when
  words TEXT NOT NULL -- what was noted
) STRICT;

CREATE TABLE tombstone (
  person TEXT PRIMARY KEY, -- recognises the participant in copies of the database
  participant TEXT NOT NULL UNIQUE, -- participant code
  code TEXT NOT NULL, -- participant code as given at the station
  station TEXT NOT NULL, -- station of the first session
  withdrawn_utc TEXT NOT NULL -- when
) STRICT;

CREATE TABLE export (
  export_id INTEGER PRIMARY KEY, -- row number
  kind TEXT NOT NULL, -- csv, bids, psych-ds, or the command that wrote it
  path TEXT NOT NULL, -- where: absolute, without links
  host TEXT NOT NULL, -- name of the computer; empty: not known
  sha256 TEXT NOT NULL, -- of a file's bytes, of the names in a folder; empty: not known, or never finished
  utc TEXT NOT NULL, -- when
  tackled INTEGER NOT NULL CHECK (tackled IN (0, 1)), -- 1: a withdrawal began to delete it or said that it cannot
  UNIQUE (host, path)
) STRICT;

CREATE TABLE export_person (
  export_id INTEGER NOT NULL REFERENCES export, -- export
  person TEXT NOT NULL, -- participant in it, as in session
  PRIMARY KEY (export_id, person)
) STRICT, WITHOUT ROWID;

CREATE TABLE chore (
  chore_id INTEGER PRIMARY KEY, -- order
  kind TEXT NOT NULL CHECK (kind IN ('backups', 'personal', 'rename', 'rewrite')), -- backups, personal: delete a person there; rename: new codes in the personal file; rewrite: this file
  batch TEXT NOT NULL, -- the commit that wrote it: renames of one are done at once, and once only
  person TEXT NOT NULL, -- person concerned; empty: nobody
  participant TEXT NOT NULL, -- code under which files beside this one know the person
  renamed TEXT -- rename: the new code
) STRICT;

CREATE TABLE "frame" (
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

CREATE TABLE "session" (
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
  ended_utc TEXT, station_number INTEGER /* number of the station among those of the study, from 1; it chose the slot and the seed; empty: the station had no number */, station_count INTEGER /* stations of the study, as this one was told; empty: likewise */, not_before_utc TEXT /* latest time that stood in the database when the session was planned: the session came after it, whatever its clock says; empty: nothing stood there, or recorded by an earlier version */, imported_from TEXT /* program that recorded the session elsewhere, as the mapping of vip-study import names it; empty: vip-study recorded it */, source_sha256 TEXT /* SHA-256 of the file from which its answers were imported; empty: not imported */, reservation TEXT /* slot that a central database reserved for it: token, full stop and place of reserved_slot; empty: the station chose the slot itself */, -- last unit done, or ended early
  UNIQUE (participant, protocol_id, visit)
) STRICT;

CREATE TABLE "presentation" (
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

CREATE TABLE "response" (
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

CREATE TABLE "gaze" (
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

CREATE TABLE ipd (
  ipd_id INTEGER PRIMARY KEY, -- row number
  session_id INTEGER NOT NULL REFERENCES session, -- session it concerns
  clock_ns INTEGER NOT NULL, -- when, on the session's clock, ns
  ipd_mm REAL NOT NULL CHECK (ipd_mm > 0) -- interpupillary distance, mm
) STRICT;

CREATE TABLE slot (
  presentation_id INTEGER NOT NULL REFERENCES presentation, -- presentation it belongs to
  slot_index INTEGER NOT NULL CHECK (slot_index >= 0), -- from 0
  predicted_ns INTEGER NOT NULL, -- when it was to be seen as the runtime predicted, after the presentation's start_ns, ns
  period_ns INTEGER NOT NULL, -- predicted period as the runtime told it with the slot, ns
  should_render INTEGER NOT NULL CHECK (should_render IN (0, 1)), -- 0: nothing of it would be seen
  frame_index INTEGER, -- frame that was on, as in frame; empty: black
  PRIMARY KEY (presentation_id, slot_index)
) STRICT, WITHOUT ROWID;

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

CREATE TABLE "cell" (
  protocol_id INTEGER NOT NULL REFERENCES protocol, -- protocol that shows it
  cell INTEGER NOT NULL CHECK (cell >= 0), -- index in the protocol's design
  scene TEXT NOT NULL, -- scene file
  method TEXT NOT NULL, -- LoRes, HiRes, FovFluid, Ours or Ours-TSp
  n_star TEXT NOT NULL, -- n_*, particles when all are coarsest
  mean_fps REAL NOT NULL CHECK (mean_fps >= 0), -- wished mean frame rate; 0: as fast as the method runs, frames/s
  sd_fps REAL NOT NULL CHECK (sd_fps >= 0), -- wished standard deviation of the frame rate, frames/s
  duration_s REAL NOT NULL CHECK (duration_s > 0), -- wished length, s
  effects TEXT, -- level of the factor effects: none, scene or a name in the protocol; empty: the design does not vary them, and the scene has its own
  effect_set TEXT, levels TEXT /* levels of the protocol's own factors, as "factor = level", one on a line; empty: a protocol of format 2 */, timing TEXT /* timing profile in words; mean_fps and sd_fps are those of its intervals; empty: mean_fps and sd_fps alone */, surface TEXT /* how its particles are drawn: ellipsoids or spheres; empty: the protocol names no surface */, -- what that level holds, as the protocol says it, SI units; empty: likewise
  CHECK ((effects IS NULL) = (effect_set IS NULL)),
  PRIMARY KEY (protocol_id, cell)
) STRICT, WITHOUT ROWID;

CREATE TABLE "permission_change" (
  permission_change_id INTEGER PRIMARY KEY, -- row number
  session_id INTEGER NOT NULL REFERENCES session, -- session it concerns
  what TEXT NOT NULL CHECK (what IN ('gaze', 'sharing')), -- gaze: kept in this database; sharing: part of public exports
  granted INTEGER NOT NULL CHECK (granted IN (0, 1)), -- 1: allowed, 0: refused
  utc TEXT NOT NULL, -- when, by a clock that may have been wrong
  uid TEXT, -- recognises the change in copies of the database; empty: an earlier version, whose changes are recognised by utc
  turn INTEGER, -- order: one more than the largest among the session's changes that the database held then
  answers INTEGER, -- answers that the session had then on consent pages to the question about it
  showings INTEGER, -- presentations of the session that had begun then
  superseded INTEGER CHECK (superseded IN (0, 1)) -- 1: a later change was made in a database that held this one, and counts instead
) STRICT;

CREATE TABLE label (
  kind TEXT NOT NULL CHECK (kind IN ('person', 'protocol')), -- what it names
  owner TEXT NOT NULL, -- person: as in session; protocol: its sha256
  label TEXT NOT NULL COLLATE NOCASE, -- letters and digits alone, as BIDS and Psych-DS ask, in files "sub-<label>"
  PRIMARY KEY (kind, owner),
  UNIQUE (kind, label)
) STRICT;

CREATE TABLE marker (
  marker_id INTEGER PRIMARY KEY, -- row number
  session_id INTEGER NOT NULL REFERENCES session, -- session it belongs to
  receiver TEXT NOT NULL, -- where it was sent, as --markers named it
  event TEXT NOT NULL, -- what happened, such as stimulus_onset
  code INTEGER NOT NULL CHECK (code BETWEEN 1 AND 255), -- its byte
  slot INTEGER NOT NULL CHECK (slot >= 0), -- position of the participant in the assignment
  position INTEGER CHECK (position >= 0), -- position of the unit in the session, as in unit; empty: begin or end of a session
  attempt INTEGER CHECK (attempt >= 1), -- showing of the trial; empty: not in a trial
  stimulus INTEGER CHECK (stimulus IN (1, 2)), -- 1: first or only stimulus, 2: second of a pair; empty: not an onset
  clock_ns INTEGER NOT NULL, -- when it happened on the computer's clock (CLOCK_MONOTONIC), ns
  display_ns INTEGER, -- of an onset: predicted time on the display on that clock, ns; empty: not known
  utc TEXT NOT NULL, -- when it happened, by the computer's clock
  latency_ns INTEGER, -- from clock_ns to the completed write, ns; empty: lost
  lost TEXT, -- why the receiver did not get it; empty: it was written
  CHECK ((latency_ns IS NULL) = (lost IS NOT NULL))
) STRICT;

CREATE TABLE tracker_clock (
  tracker_clock_id INTEGER PRIMARY KEY, -- row number
  session_id INTEGER NOT NULL REFERENCES session, -- session it belongs to
  source TEXT NOT NULL, -- where samples came from, as --gaze named it
  device TEXT NOT NULL, -- name that the sender gave of the eye tracker
  yaw_deg REAL NOT NULL, -- fixed rotation of its rays (--gaze-turn) to the left, degrees
  pitch_deg REAL NOT NULL, -- up
  roll_deg REAL NOT NULL, -- leaning to the left
  clock_ns INTEGER NOT NULL, -- when the offset was measured, on the computer's clock (CLOCK_MONOTONIC), ns
  offset_ns INTEGER NOT NULL, -- what is added to the tracker's times to get times of the computer's clock, ns
  round_trip_ns INTEGER NOT NULL CHECK (round_trip_ns >= 0), -- of the exchange that gave it, ns: it is right within half of that
  utc TEXT NOT NULL -- when the offset was measured, by the computer's clock
) STRICT;

CREATE TABLE light (
  presentation_id INTEGER PRIMARY KEY REFERENCES presentation, -- presentation whose light patch a sensor recorded
  log_sha256 TEXT NOT NULL CHECK (length(log_sha256) = 64), -- SHA-256 of the sensor's log
  read_utc TEXT NOT NULL, -- when the log was read
  interval_ms REAL NOT NULL CHECK (interval_ms > 0), -- time between its samples, ms
  grade TEXT CHECK (grade IN ('A', 'B')), -- evidence that the light is: A or B; empty: neither, so that the presentation's own grade stays
  why_not TEXT, -- what A lacks; empty: nothing
  frames INTEGER NOT NULL, -- recorded onsets
  matched INTEGER NOT NULL, -- onsets with a change of light
  missed INTEGER NOT NULL, -- frames whose brightness was never seen
  missed_frames TEXT NOT NULL, -- their indices as in frame, separated by spaces
  hidden INTEGER NOT NULL, -- frames that were seen, and whose onset is no change, as the frame before was missed
  extra INTEGER NOT NULL, -- changes of light without an onset
  lag_ms REAL, -- mean time from onset to light, ms; empty: no onset has light
  lag_absolute INTEGER NOT NULL CHECK (lag_absolute IN (0, 1)), -- 1: by triggers in the log; 0: relative to the median presentation of the session
  jitter_ms REAL, -- standard deviation of that time, ms; empty: likewise
  worst_ms REAL, -- largest deviation from lag_ms, ms; empty: likewise
  drift_ppm REAL NOT NULL -- how much faster the sensor's clock ran than the computer's, parts per million
) STRICT;

CREATE TABLE reserved_slot (
  token TEXT NOT NULL CHECK (length(token) = 32), -- random; recognises the request for slots, which may be sent again
  place INTEGER NOT NULL CHECK (place >= 0), -- number of the slot in its request, from 0
  service TEXT NOT NULL, -- central database that was asked, by its name in the file of services
  protocol_sha256 TEXT NOT NULL CHECK (length(protocol_sha256) = 64), -- protocol of the assignment, as in protocol
  slots INTEGER NOT NULL CHECK (slots >= 1), -- slots that its assignment has
  block INTEGER NOT NULL CHECK (block IN (0, 1)), -- 1: reserved in advance, kept for times without a network; 0: asked for by a run
  slot INTEGER CHECK (slot >= 0 AND slot < slots), -- slot of the assignment, as in session; empty: the answer did not come yet
  state TEXT NOT NULL CHECK (state IN ('asked', 'held', 'returning', 'returned')), -- asked: the answer did not come yet; held: a session has it, or may take it; returning: the central database does not know yet; returned: it does
  asked_utc TEXT NOT NULL, -- when it was asked for
  CHECK ((slot IS NULL) = (state = 'asked')),
  PRIMARY KEY (token, place)
) STRICT, WITHOUT ROWID;

CREATE INDEX event_of_session ON event (session_id);

CREATE INDEX unit_of_trial ON unit (trial_id);

CREATE INDEX framing_of_scene ON framing (session_id, scene);

CREATE INDEX session_of_person ON session (person);

CREATE INDEX headset_of_session ON headset (session_id);

CREATE INDEX ipd_of_session ON ipd (session_id);

CREATE INDEX permission_change_of_session ON permission_change (session_id);

CREATE INDEX marker_of_session ON marker (session_id);

CREATE INDEX tracker_clock_of_session ON tracker_clock (session_id);

CREATE TRIGGER event_is_final BEFORE UPDATE ON event BEGIN SELECT RAISE(ABORT, 'the event log is append-only'); END;

CREATE TRIGGER event_is_kept BEFORE DELETE ON event
  WHEN NOT EXISTS (SELECT 1 FROM session s JOIN tombstone t USING (person) WHERE s.session_id = OLD.session_id)
  BEGIN SELECT RAISE(ABORT, 'the event log is append-only'); END;

CREATE VIEW sharing AS
  SELECT person, min(granted) AS granted FROM permission WHERE what = 'sharing' GROUP BY person;

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

CREATE VIEW trial_showing AS
  SELECT trial_id, coalesce(min(attempt) FILTER (WHERE answered), max(attempt)) AS attempt FROM judgement GROUP BY trial_id;

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

CREATE VIEW answer AS
  SELECT response_id, why_not, why_not IS NULL AS counts FROM (
    SELECT r.response_id, CASE WHEN u.trial_id IS NULL THEN NULL
      WHEN r.attempt <= t.set_aside THEN 'set aside'
      WHEN j.response_id IS NULL THEN 'answered again' ELSE j.why_not END AS why_not
    FROM response r JOIN unit u USING (unit_id) LEFT JOIN trial t USING (trial_id)
      LEFT JOIN judgement j ON j.unit_id = r.unit_id AND j.question_id = r.question_id AND j.response_id = r.response_id);

CREATE VIEW solving AS
  SELECT presentation_id,
    (SELECT avg(active_fraction) FROM frame f WHERE f.presentation_id = p.presentation_id) AS active_fraction,
    (SELECT avg(tau_fps) FROM frame f WHERE f.presentation_id = p.presentation_id) AS tau_fps
  FROM presentation p;

CREATE VIEW permission_answer AS
  SELECT s.session_id, w.what,
    (SELECT coalesce(r.score = 1 AND q.kind = 'choice' AND q.scale_min = 0 AND q.scale_max = 1, 0)
      FROM response r JOIN unit u USING (unit_id) WHERE u.session_id = s.session_id AND r.question_id = q.question_id
      ORDER BY r.response_id DESC LIMIT 1) AS answered,
    (SELECT count(*) FROM response r JOIN unit u USING (unit_id)
      WHERE u.session_id = s.session_id AND r.question_id = q.question_id) AS answers
  FROM session s JOIN question q USING (protocol_id)
    JOIN (SELECT 'gaze' AS what, 'gaze_kept' AS code UNION ALL SELECT 'sharing', 'data_shared') w ON w.code = q.code;

CREATE VIEW permission AS
  SELECT session_id, person, what,
    CASE WHEN changed AND live IS NULL AND page IS NULL THEN 0 ELSE min(coalesce(live, page), coalesce(page, live)) END AS granted
  FROM (SELECT s.session_id, s.person, w.what,
      (SELECT min(c.granted) FROM permission_change c
        WHERE c.session_id = s.session_id AND c.what = w.what AND c.superseded IS NOT 1) AS live,
      (SELECT coalesce(a.answered, 0) FROM permission_answer a WHERE a.session_id = s.session_id AND a.what = w.what
        AND NOT EXISTS (SELECT 1 FROM permission_change c
          WHERE c.session_id = s.session_id AND c.what = w.what AND c.answers >= a.answers)) AS page,
      EXISTS (SELECT 1 FROM permission_change c WHERE c.session_id = s.session_id AND c.what = w.what) AS changed
    FROM session s CROSS JOIN (SELECT 'gaze' AS what UNION ALL SELECT 'sharing') w);

CREATE VIEW evidence AS
  SELECT p.presentation_id, coalesce(min(l.grade, p.grade), p.grade) AS grade FROM presentation p LEFT JOIN light l USING (presentation_id);
