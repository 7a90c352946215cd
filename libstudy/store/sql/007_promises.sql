-- Step 7. What people decided, and what was exported, in full: each section stands by itself.
-- Stations and their clocks. An added column has its meaning in /* */: SQLite writes it into the line of the column
-- before it, where a comment to the end of the line would hide what follows.
ALTER TABLE session ADD COLUMN station_number INTEGER /* number of the station among those of the study, from 1; it chose the slot and the seed; empty: the station had no number */;
ALTER TABLE session ADD COLUMN station_count INTEGER /* stations of the study, as this one was told; empty: likewise */;
ALTER TABLE session ADD COLUMN not_before_utc TEXT /* latest time that stood in the database when the session was planned: the session came after it, whatever its clock says; empty: nothing stood there, or recorded by an earlier version */;
