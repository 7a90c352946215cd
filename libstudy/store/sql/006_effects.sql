-- Step 6. Adds effects as a factor of the design. legacy_alter_table keeps the table's name in views and
-- references while the table is made anew.
PRAGMA legacy_alter_table = ON;
CREATE TABLE cell_2 (
  protocol_id INTEGER NOT NULL REFERENCES protocol, -- protocol that shows it
  cell INTEGER NOT NULL CHECK (cell >= 0), -- index in the protocol's design
  scene TEXT NOT NULL, -- scene file
  method TEXT NOT NULL, -- LoRes, HiRes, FovFluid, Ours or Ours-TSp
  n_star TEXT NOT NULL, -- n_*, particles when all are coarsest
  mean_fps REAL NOT NULL CHECK (mean_fps >= 0), -- wished mean frame rate; 0: as fast as the method runs, frames/s
  sd_fps REAL NOT NULL CHECK (sd_fps >= 0), -- wished standard deviation of the frame rate, frames/s
  duration_s REAL NOT NULL CHECK (duration_s > 0), -- wished length, s
  effects TEXT, -- level of the factor effects: none, scene or a name in the protocol; empty: the design does not vary them, and the scene has its own
  effect_set TEXT, -- what that level holds, as the protocol says it, SI units; empty: likewise
  CHECK ((effects IS NULL) = (effect_set IS NULL)),
  PRIMARY KEY (protocol_id, cell)
) STRICT, WITHOUT ROWID;
INSERT INTO cell_2 SELECT *, NULL, NULL FROM cell;
DROP TABLE cell;
ALTER TABLE cell_2 RENAME TO cell;
PRAGMA legacy_alter_table = OFF;
