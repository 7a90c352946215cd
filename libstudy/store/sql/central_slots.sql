-- Slots of the assignment that the central database deals to its stations (docs/central.md). Not a step of the
-- local schema: vip-study central init and upgrade run it, and it changes nothing that stands there already.
--
-- A slot's uses are the sessions that count (open, done or stopped) and the open reservations without such a
-- session. A reservation is open until its station returns it.

-- How many slots the assignment of a protocol has, so that stations of different versions are noticed.
CREATE TABLE IF NOT EXISTS vip.slot_count (
  protocol_sha256 text PRIMARY KEY CHECK (length(protocol_sha256) = 64),
  slots bigint NOT NULL CHECK (slots BETWEEN 1 AND 1000000)
);

CREATE TABLE IF NOT EXISTS vip.reservation (
  token text NOT NULL CHECK (token ~ '^[0-9a-f]{32}$'), -- of the request, made by the station
  place bigint NOT NULL CHECK (place >= 0), -- number of the slot in its request, from 0
  sender text NOT NULL, -- role of the station that asked
  protocol_sha256 text NOT NULL REFERENCES vip.slot_count,
  slot bigint NOT NULL CHECK (slot >= 0),
  asked timestamptz NOT NULL DEFAULT now(),
  returned timestamptz, -- NULL: the station may use it
  PRIMARY KEY (token, place)
);

CREATE INDEX IF NOT EXISTS reservation_of_protocol ON vip.reservation (protocol_sha256) WHERE returned IS NULL;
CREATE INDEX IF NOT EXISTS session_of_reservation ON vip.session (reservation) WHERE reservation IS NOT NULL;

-- Sessions that count as uses of their slot, as Store::taken_slots() has them. Of a session that several stations
-- sent, one copy counts.
CREATE OR REPLACE VIEW vip.slot_session AS
  SELECT s.protocol_sha256, s.slot, s.reservation FROM vip.session s
  JOIN vip.chosen c ON c.session_uid = s.session_uid AND c.sender = s.sender
  JOIN vip.protocol p ON p.protocol_sha256 = s.protocol_sha256 AND p.sender = s.sender
  WHERE s.state IN ('open', 'done', 'stopped') AND s.test_data = p.test_data;

-- Reservations that count as uses of their slot.
CREATE OR REPLACE VIEW vip.open_reservation AS
  SELECT r.sender, r.protocol_sha256, r.slot, r.token, r.place FROM vip.reservation r
  WHERE r.returned IS NULL
    AND NOT EXISTS (SELECT 1 FROM vip.slot_session s WHERE s.reservation = r.token || '.' || r.place);

-- The slots of a request, by place: those that are used least, the lowest first. A token that was seen before
-- gets the same slots.
CREATE OR REPLACE FUNCTION vip.reserve_slots(wanted_token text, protocol text, slots bigint, wanted bigint)
RETURNS TABLE (place bigint, slot bigint)
LANGUAGE plpgsql SECURITY DEFINER SET search_path = pg_catalog, pg_temp AS $$
#variable_conflict use_column
DECLARE
  known bigint;
BEGIN
  IF wanted IS NULL OR wanted NOT BETWEEN 1 AND 10000 THEN
    RAISE EXCEPTION 'a request is for 1 to 10000 slots' USING ERRCODE = 'check_violation';
  END IF;
  -- Each statement below must see what the requests before it committed.
  IF current_setting('transaction_isolation') <> 'read committed' THEN
    RAISE EXCEPTION 'slots are reserved in transactions of isolation READ COMMITTED'
      USING ERRCODE = 'invalid_transaction_state';
  END IF;
  -- One request at a time for each protocol.
  PERFORM pg_advisory_xact_lock(hashtextextended('vip.slots ' || protocol, 0));
  INSERT INTO vip.slot_count VALUES (protocol, slots) ON CONFLICT DO NOTHING;
  SELECT c.slots INTO known FROM vip.slot_count c WHERE c.protocol_sha256 = protocol;
  IF known <> slots THEN
    RAISE EXCEPTION 'the assignment of this protocol has % slots here, and % at the station', known, slots
      USING ERRCODE = 'check_violation', HINT = 'use one version of vip-study at all stations';
  END IF;
  IF NOT EXISTS (SELECT 1 FROM vip.reservation r WHERE r.token = wanted_token) THEN
    INSERT INTO vip.reservation (token, place, sender, protocol_sha256, slot)
      WITH used AS (
        SELECT u.slot % slots AS slot, count(*) AS uses FROM (
          SELECT s.slot FROM vip.slot_session s WHERE s.protocol_sha256 = protocol
          UNION ALL SELECT o.slot FROM vip.open_reservation o WHERE o.protocol_sha256 = protocol) u
        GROUP BY 1),
      uses AS (
        SELECT n AS slot, coalesce(used.uses, 0) AS uses FROM generate_series(0, slots - 1) n
        LEFT JOIN used ON used.slot = n),
      bounds AS (SELECT least(min(u.uses) + wanted, max(u.uses) + wanted / slots + 1) AS most FROM uses u)
      -- Fills from below: each use of a slot comes after all slots with fewer uses.
      SELECT wanted_token, row_number() OVER (ORDER BY turn, uses.slot) - 1, session_user, protocol, uses.slot
      FROM uses, bounds, generate_series(uses.uses, bounds.most) turn
      ORDER BY turn, uses.slot LIMIT wanted;
  END IF;
  IF EXISTS (SELECT 1 FROM vip.reservation r WHERE r.token = wanted_token
             AND (r.sender <> session_user OR r.protocol_sha256 <> protocol)) THEN
    RAISE EXCEPTION 'this request is of another station or protocol' USING ERRCODE = 'insufficient_privilege';
  END IF;
  RETURN QUERY SELECT r.place, r.slot FROM vip.reservation r WHERE r.token = wanted_token ORDER BY r.place;
END $$;

-- Returns slots of a request; those that were returned before are left as they are.
CREATE OR REPLACE FUNCTION vip.return_slots(wanted_token text, places bigint[]) RETURNS void
LANGUAGE sql SECURITY DEFINER SET search_path = pg_catalog, pg_temp AS $$
  UPDATE vip.reservation SET returned = now()
  WHERE token = wanted_token AND place = ANY (places) AND sender = session_user AND returned IS NULL
$$;

-- For the owner: returns all slots of a station whose computer is lost.
CREATE OR REPLACE FUNCTION vip.release_station(name text) RETURNS bigint
LANGUAGE sql SET search_path = pg_catalog, pg_temp AS $$
  WITH released AS (UPDATE vip.reservation SET returned = now() WHERE sender = name AND returned IS NULL
                    RETURNING 1)
  SELECT count(*) FROM released
$$;

REVOKE ALL ON vip.slot_count, vip.reservation, vip.slot_session, vip.open_reservation FROM PUBLIC;
REVOKE ALL ON FUNCTION vip.reserve_slots(text, text, bigint, bigint), vip.return_slots(text, bigint[]),
  vip.release_station(text) FROM PUBLIC;
GRANT EXECUTE ON FUNCTION vip.reserve_slots(text, text, bigint, bigint), vip.return_slots(text, bigint[])
  TO {station};
