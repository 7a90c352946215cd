-- Step 14. Adds how the particles of a cell are drawn.
ALTER TABLE cell ADD COLUMN surface TEXT /* how its particles are drawn: ellipsoids or spheres; empty: the protocol names no surface */;
