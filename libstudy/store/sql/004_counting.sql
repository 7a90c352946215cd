-- Step 4.

-- A refused consent is a state of its own. Views and references name the table all the while.
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
  gaze_source TEXT NOT NULL CHECK (gaze_source IN ('tracked', 'mouse', 'fixed', 'none')), -- tracked, mouse, fixed or none
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
