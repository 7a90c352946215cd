-- Step 8. Protocols of format 3: adds factors that a protocol defines, timing profiles and more kinds of
-- answers. The comment of an added column is in /* */, because SQLite writes the column into the line of the
-- column before it.
ALTER TABLE cell ADD COLUMN levels TEXT /* levels of the protocol's own factors, as "factor = level", one on a line; empty: a protocol of format 2 */;
ALTER TABLE cell ADD COLUMN timing TEXT /* timing profile in words; mean_fps and sd_fps are those of its intervals; empty: mean_fps and sd_fps alone */;
ALTER TABLE presentation ADD COLUMN p99_ms REAL /* 99th percentile of the intervals, ms; empty: an earlier version, which did not write it */;
ALTER TABLE presentation ADD COLUMN hitches INTEGER /* intervals longer than 1.5 times the median interval; empty: an earlier version, which did not write it */;
ALTER TABLE presentation ADD COLUMN animation_error_ms REAL /* mean absolute difference between the step of the simulated time and the interval of a frame, ms; empty: content followed frames instead of time, or an earlier version */;

-- Removes the CHECK on the kind of a question: only the program lists the kinds.
PRAGMA legacy_alter_table = ON;
CREATE TABLE question_2 (
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
INSERT INTO question_2 SELECT * FROM question ORDER BY question_id;
DROP TABLE question;
ALTER TABLE question_2 RENAME TO question;
PRAGMA legacy_alter_table = OFF;
