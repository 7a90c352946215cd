-- Step 10. Markers that a session sent to recording systems, such as EEG, and how long each took.
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
CREATE INDEX marker_of_session ON marker (session_id);
