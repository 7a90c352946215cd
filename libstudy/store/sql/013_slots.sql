-- Step 13. Slots of the assignment that a central database reserved for this station, and which session took one.
ALTER TABLE session ADD COLUMN reservation TEXT /* slot that a central database reserved for it: token, full stop and place of reserved_slot; empty: the station chose the slot itself */;
CREATE TABLE reserved_slot (
  token TEXT NOT NULL CHECK (length(token) = 32), -- random; recognises the request for slots, which may be sent again
  place INTEGER NOT NULL CHECK (place >= 0), -- number of the slot in its request, from 0
  service TEXT NOT NULL, -- central database that was asked, by its name in the file of services
  protocol_sha256 TEXT NOT NULL CHECK (length(protocol_sha256) = 64), -- protocol of the assignment, as in protocol
  slots INTEGER NOT NULL CHECK (slots >= 1), -- slots that its assignment has
  block INTEGER NOT NULL CHECK (block IN (0, 1)), -- 1: reserved in advance, kept for times without a network; 0: asked for by a run
  slot INTEGER CHECK (slot >= 0 AND slot < slots), -- slot of the assignment, as in session; empty: the answer did not come yet
  state TEXT NOT NULL CHECK (state IN ('asked', 'held', 'returning', 'returned')), -- asked: the answer did not come yet; held: a session has it, or may take it; returning: the central database does not know yet; returned: it does
  asked_utc TEXT NOT NULL, -- when it was asked for
  CHECK ((slot IS NULL) = (state = 'asked')),
  PRIMARY KEY (token, place)
) STRICT, WITHOUT ROWID;
