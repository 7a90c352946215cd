
-- How each session's display framed each scene of its protocol. No row: nothing was drawn, or an earlier version, which did not
-- write it.
CREATE TABLE framing (
  framing_id INTEGER PRIMARY KEY, -- row number
  session_id INTEGER NOT NULL REFERENCES session, -- session it concerns
  scene TEXT NOT NULL, -- scene file, as in cell
  width_px INTEGER NOT NULL CHECK (width_px > 0), -- width of the picture as it is drawn, px
  height_px INTEGER NOT NULL CHECK (height_px > 0), -- its height, px
  shown_width_px INTEGER NOT NULL CHECK (shown_width_px > 0), -- width of the picture on the display; another where a bake's pictures are scaled, px
  shown_height_px INTEGER NOT NULL CHECK (shown_height_px > 0), -- likewise its height, px
  camera_angle_deg REAL NOT NULL CHECK (camera_angle_deg > 0 AND camera_angle_deg < 180), -- vertical angle of the camera, degrees
  visual_angle_deg REAL CHECK (visual_angle_deg > 0 AND visual_angle_deg < 180), -- vertical angle that the picture fills of the eye's view, in which eccentricity is taken; empty: not known, then it is taken in the camera's, degrees
  angle_ratio REAL CHECK (angle_ratio > 0), -- visual_angle_deg by camera_angle_deg; empty: not known
  UNIQUE (session_id, scene)
) STRICT;
