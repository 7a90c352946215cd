-- Step 11. Eye trackers outside OpenXR: which one a session used, and how its clock stood to the computer's.
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
CREATE INDEX tracker_clock_of_session ON tracker_clock (session_id);
