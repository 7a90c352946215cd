-- Step 7. Adds station numbers, a rule for permissions in merges, and stored labels for exports.

-- Columns for stations and their clocks. The comment of an added column is in /* */, because SQLite writes
-- the column into the line of the column before it, where a comment to the end of the line would hide what
-- follows.
ALTER TABLE session ADD COLUMN station_number INTEGER /* number of the station among those of the study, from 1; it chose the slot and the seed; empty: the station had no number */;
ALTER TABLE session ADD COLUMN station_count INTEGER /* stations of the study, as this one was told; empty: likewise */;
ALTER TABLE session ADD COLUMN not_before_utc TEXT /* latest time that stood in the database when the session was planned: the session came after it, whatever its clock says; empty: nothing stood there, or recorded by an earlier version */;

-- Adds columns from which a merge of copies finds the permission changes that count. Times do not decide
-- this, because clocks can jump. The table is made anew, so that each column keeps its comment;
-- legacy_alter_table keeps the table's name in views.
PRAGMA legacy_alter_table = ON;
CREATE TABLE permission_change_2 (
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
INSERT INTO permission_change_2 SELECT permission_change_id, session_id, what, granted, utc, NULL,
    row_number() OVER (PARTITION BY session_id ORDER BY permission_change_id),
    (SELECT count(*) FROM response r JOIN unit u USING (unit_id) JOIN question q USING (question_id)
      WHERE u.session_id = c.session_id AND q.code = CASE c.what WHEN 'gaze' THEN 'gaze_kept' ELSE 'data_shared' END),
    (SELECT count(*) FROM presentation p JOIN trial t USING (trial_id) WHERE t.session_id = c.session_id AND p.started_utc <= c.utc),
    EXISTS (SELECT 1 FROM permission_change l WHERE l.session_id = c.session_id AND l.what = c.what
      AND l.permission_change_id > c.permission_change_id)
  FROM permission_change c ORDER BY permission_change_id;
DROP TABLE permission_change;
ALTER TABLE permission_change_2 RENAME TO permission_change;
PRAGMA legacy_alter_table = OFF;
CREATE INDEX permission_change_of_session ON permission_change (session_id);

-- As before, with the additional column answers: how many answers about the permission the session has.
DROP VIEW permission_answer;
CREATE VIEW permission_answer AS
  SELECT s.session_id, w.what,
    (SELECT coalesce(r.score = 1 AND q.kind = 'choice' AND q.scale_min = 0 AND q.scale_max = 1, 0)
      FROM response r JOIN unit u USING (unit_id) WHERE u.session_id = s.session_id AND r.question_id = q.question_id
      ORDER BY r.response_id DESC LIMIT 1) AS answered,
    (SELECT count(*) FROM response r JOIN unit u USING (unit_id)
      WHERE u.session_id = s.session_id AND r.question_id = q.question_id) AS answers
  FROM session s JOIN question q USING (protocol_id)
    JOIN (SELECT 'gaze' AS what, 'gaze_kept' AS code UNION ALL SELECT 'sharing', 'data_shared') w ON w.code = q.code;

-- The permissions in force in each session. granted: 1 allowed; 0 refused, or asked and not answered yet;
-- empty: never asked and never changed. The view uses all changes that no later change supersedes, and the
-- last answer on a page unless a change was made after it. One refusal among them is enough, because after a
-- merge they may come from copies that did not know of each other.
DROP VIEW permission;
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

-- Labels of people and protocols in public exports. A label is assigned once; another person or protocol
-- never gets it, not even after a withdrawal.
CREATE TABLE label (
  kind TEXT NOT NULL CHECK (kind IN ('person', 'protocol')), -- what it names
  owner TEXT NOT NULL, -- person: as in session; protocol: its sha256
  label TEXT NOT NULL COLLATE NOCASE, -- letters and digits alone, as BIDS and Psych-DS ask, in files "sub-<label>"
  PRIMARY KEY (kind, owner),
  UNIQUE (kind, label)
) STRICT;
