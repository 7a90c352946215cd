-- Step 12. What a light sensor on the display saw of a presentation, and the grade of evidence that follows.
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
CREATE VIEW evidence AS
  SELECT p.presentation_id, coalesce(min(l.grade, p.grade), p.grade) AS grade FROM presentation p LEFT JOIN light l USING (presentation_id);
