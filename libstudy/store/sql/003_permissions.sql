-- Step 3. Adds participants' permissions, gaze samples, the register of exports with the people in them, and
-- the list of clean-up work on files beside the database.

-- Permissions that the experimenter changed after the consent page (questions gaze_kept and data_shared), and
-- answers that the participant gave after such a change. The last row counts.
CREATE TABLE permission_change (
  permission_change_id INTEGER PRIMARY KEY, -- order of changes
  session_id INTEGER NOT NULL REFERENCES session, -- session it concerns
  what TEXT NOT NULL CHECK (what IN ('gaze', 'sharing')), -- gaze: kept in this database; sharing: part of public exports
  granted INTEGER NOT NULL CHECK (granted IN (0, 1)), -- 1: allowed, 0: refused
  utc TEXT NOT NULL -- when
) STRICT;
CREATE INDEX permission_change_of_session ON permission_change (session_id);

-- The participant's answer about each permission in each session. answered: 1 yes, 0 no, empty: not answered
-- yet. An answer on a scale other than no = 0 and yes = 1, which earlier versions allowed, is read as no. No
-- row: the protocol does not ask.
CREATE VIEW permission_answer AS
  SELECT s.session_id, w.what,
    (SELECT coalesce(r.score = 1 AND q.kind = 'choice' AND q.scale_min = 0 AND q.scale_max = 1, 0)
      FROM response r JOIN unit u USING (unit_id) WHERE u.session_id = s.session_id AND r.question_id = q.question_id
      ORDER BY r.response_id DESC LIMIT 1) AS answered
  FROM session s JOIN question q USING (protocol_id)
    JOIN (SELECT 'gaze' AS what, 'gaze_kept' AS code UNION ALL SELECT 'sharing', 'data_shared') w ON w.code = q.code;

-- The permissions in force in each session. granted: 1 allowed; 0 refused, or asked and not answered yet;
-- empty: the protocol does not ask.
CREATE VIEW permission AS
  SELECT s.session_id, s.person, w.what, coalesce(
    (SELECT c.granted FROM permission_change c WHERE c.session_id = s.session_id AND c.what = w.what
      ORDER BY c.permission_change_id DESC LIMIT 1),
    (SELECT coalesce(a.answered, 0) FROM permission_answer a WHERE a.session_id = s.session_id AND a.what = w.what)) AS granted
  FROM session s CROSS JOIN (SELECT 'gaze' AS what UNION ALL SELECT 'sharing') w;

-- The permission of each person to be in public exports. A refusal in one session applies to all sessions of
-- the person. granted: as in the view permission.
CREATE VIEW sharing AS
  SELECT person, min(granted) AS granted FROM permission WHERE what = 'sharing' GROUP BY person;

-- Gaze samples, one row for each sample that the source delivered. Recorded only if the participant allowed
-- it.
CREATE TABLE gaze (
  presentation_id INTEGER NOT NULL REFERENCES presentation, -- presentation it belongs to
  sample_index INTEGER NOT NULL CHECK (sample_index >= 0), -- from 0
  source TEXT NOT NULL CHECK (source IN ('tracker', 'mouse')), -- tracker: an eye tracker; mouse: the pointer, which people often do not look at
  sampled_ns INTEGER NOT NULL, -- when the sample came, after the presentation's start_ns, ns
  device_ns INTEGER, -- the device's own time stamp; empty: it gives none, ns
  valid INTEGER NOT NULL CHECK (valid IN (0, 1)), -- 1: the source knew where; 0: a blink, or off the picture
  x REAL, -- from the left edge, as a share of the picture's width; empty: not known
  y REAL, -- from the top edge, as a share of the picture's height; empty: not known
  PRIMARY KEY (presentation_id, sample_index)
) STRICT, WITHOUT ROWID;

-- Files and folders outside the database that contain data of people. The row of a file is written before the
-- file's first byte.
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

-- Work that a withdrawal or a merge must do after its commit. The commit adds the row; it is deleted when the
-- work is done.
CREATE TABLE chore (
  chore_id INTEGER PRIMARY KEY, -- order
  kind TEXT NOT NULL CHECK (kind IN ('backups', 'personal', 'rename', 'rewrite')), -- backups, personal: delete a person there; rename: new codes in the personal file; rewrite: this file
  batch TEXT NOT NULL, -- the commit that wrote it: renames of one are done at once, and once only
  person TEXT NOT NULL, -- person concerned; empty: nobody
  participant TEXT NOT NULL, -- code under which files beside this one know the person
  renamed TEXT -- rename: the new code
) STRICT;

-- Earlier versions recorded exports only in the event log, without the people in them. So each of these
-- exports is registered with all people in the database.
INSERT INTO export (kind, path, host, sha256, utc, tackled)
  SELECT 'unknown', detail, '', '', min(utc), 0 FROM event WHERE kind = 'export' GROUP BY detail;
INSERT INTO export_person SELECT DISTINCT e.export_id, s.person FROM export e CROSS JOIN session s;
