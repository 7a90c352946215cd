-- Step 7. What people decided, and what was exported, in full: each section stands by itself.

-- Names of people and protocols in public exports, given once: a label never goes over to somebody else, also not after a withdrawal.
CREATE TABLE label (
  kind TEXT NOT NULL CHECK (kind IN ('person', 'protocol')), -- what it names
  owner TEXT NOT NULL, -- person: as in session; protocol: its sha256
  label TEXT NOT NULL COLLATE NOCASE, -- letters and digits alone, as BIDS and Psych-DS ask, in files "sub-<label>"
  PRIMARY KEY (kind, owner),
  UNIQUE (kind, label)
) STRICT;
