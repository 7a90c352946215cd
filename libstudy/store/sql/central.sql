-- The central database (PostgreSQL): what follows is not derived from the schema of SQLite. central_ddl.cpp
-- replaces the names in braces, makes the tables, and runs this file again at each upgrade.

-- Transactions about one person wait for each other. Otherwise a session could arrive while a withdrawal that
-- does not see it yet deletes all others. A transaction that keeps an old view of the tables is refused.
CREATE OR REPLACE FUNCTION vip.wait_for_person(person text) RETURNS void
LANGUAGE plpgsql SECURITY DEFINER SET search_path = pg_catalog, pg_temp AS $$
BEGIN
  IF current_setting('transaction_isolation') <> 'read committed' THEN
    RAISE EXCEPTION 'the transaction must be READ COMMITTED';
  END IF;
  PERFORM pg_advisory_xact_lock(hashtextextended(person, 1));
END $$;

-- A tombstone deletes the person's rows, whoever sent them. Parents go first: rows that arrive meanwhile then
-- fail, as their parent is gone.
CREATE OR REPLACE FUNCTION vip.bury() RETURNS trigger
LANGUAGE plpgsql SECURITY DEFINER SET search_path = pg_catalog, pg_temp AS $$
DECLARE
  gone record;
BEGIN
  PERFORM vip.wait_for_person(NEW.person);
  FOR gone IN DELETE FROM vip.session s WHERE s.person = NEW.person RETURNING s.session_uid, s.sender LOOP
    {bury}
    DELETE FROM vip.part t WHERE t.of = gone.session_uid AND t.sender = gone.sender;
  END LOOP;
  DELETE FROM vip.label l WHERE l.kind = 'person' AND l.owner = NEW.person;
  RETURN NULL;
END $$;
DROP TRIGGER IF EXISTS bury ON vip.tombstone;
CREATE TRIGGER bury AFTER INSERT ON vip.tombstone FOR EACH ROW EXECUTE FUNCTION vip.bury();

-- No row about a person comes after the tombstone.
CREATE OR REPLACE FUNCTION vip.refuse_withdrawn() RETURNS trigger
LANGUAGE plpgsql SECURITY DEFINER SET search_path = pg_catalog, pg_temp AS $$
DECLARE
  about text := CASE WHEN TG_TABLE_NAME = 'session' THEN to_jsonb(NEW) ->> 'person'
    WHEN to_jsonb(NEW) ->> 'kind' = 'person' THEN to_jsonb(NEW) ->> 'owner' END;
BEGIN
  IF about IS NULL THEN RETURN NEW; END IF;
  PERFORM vip.wait_for_person(about);
  IF EXISTS (SELECT 1 FROM vip.tombstone t WHERE t.person = about) THEN
    RAISE EXCEPTION 'the person withdrew' USING ERRCODE = 'VP001';
  END IF;
  RETURN NEW;
END $$;
DROP TRIGGER IF EXISTS refuse_withdrawn ON vip.session;
CREATE TRIGGER refuse_withdrawn BEFORE INSERT OR UPDATE ON vip.session
  FOR EACH ROW EXECUTE FUNCTION vip.refuse_withdrawn();
DROP TRIGGER IF EXISTS refuse_withdrawn ON vip.label;
CREATE TRIGGER refuse_withdrawn BEFORE INSERT OR UPDATE ON vip.label
  FOR EACH ROW EXECUTE FUNCTION vip.refuse_withdrawn();

-- Who of these people withdrew. A station asks about people whose random identity it knows.
CREATE OR REPLACE FUNCTION vip.withdrawn_among(people text[]) RETURNS SETOF text
LANGUAGE sql STABLE SECURITY DEFINER SET search_path = pg_catalog, pg_temp AS $$
  SELECT DISTINCT t.person FROM vip.tombstone t WHERE t.person = ANY (people)
$$;

-- The copy of each session that counts: the one with the most progress, if several stations sent it. People
-- who withdrew have none.
CREATE OR REPLACE VIEW vip.chosen AS
  SELECT DISTINCT ON (s.session_uid) s.session_uid, s.sender, s.person, s.protocol_sha256, s.run_uid
  FROM vip.session s LEFT JOIN vip.part p ON p.of = s.session_uid AND p.sender = s.sender AND p.part = 'core'
  WHERE NOT EXISTS (SELECT 1 FROM vip.tombstone t WHERE t.person = s.person)
  ORDER BY s.session_uid, p.events DESC NULLS LAST, p.progress DESC NULLS LAST, s.sender;

-- Changes of permissions, each once, as vip-study merge joins them: superseded in one copy is superseded.
CREATE OR REPLACE VIEW vip.joined_change AS
  SELECT session_uid, what, utc, granted, uid, max(answers) AS answers, max(showings) AS showings,
    coalesce(max(superseded), 0) = 1 AS superseded
  FROM vip.permission_change GROUP BY session_uid, what, utc, granted, uid;

-- As the view permission of the stations: 1 allowed, 0 refused, or asked and not answered, NULL not asked.
CREATE OR REPLACE VIEW vip.permission AS
  SELECT session_uid, sender, person, what,
    CASE WHEN changed AND live IS NULL AND page IS NULL THEN 0 ELSE least(live, page) END AS granted
  FROM (
    SELECT c.session_uid, c.sender, c.person, w.what,
      (SELECT min(j.granted) FROM vip.joined_change j
        WHERE j.session_uid = c.session_uid AND j.what = w.what AND NOT j.superseded) AS live,
      (SELECT coalesce(a.answered, 0) FROM (
          SELECT q.question_code,
            (SELECT CASE WHEN r.score = 1 AND q.kind = 'choice' AND q.scale_min = 0 AND q.scale_max = 1
                THEN 1 ELSE 0 END
              FROM vip.response r WHERE r.session_uid = c.session_uid AND r.sender = c.sender
                AND r.question_code = q.question_code ORDER BY r.response_id DESC LIMIT 1) AS answered,
            (SELECT count(*) FROM vip.response r WHERE r.session_uid = c.session_uid AND r.sender = c.sender
                AND r.question_code = q.question_code) AS answers
          FROM vip.question q WHERE q.protocol_sha256 = c.protocol_sha256 AND q.sender = c.sender
            AND q.question_code = w.code) a
        WHERE NOT EXISTS (SELECT 1 FROM vip.joined_change j
          WHERE j.session_uid = c.session_uid AND j.what = w.what AND j.answers >= a.answers)) AS page,
      EXISTS (SELECT 1 FROM vip.joined_change j
        WHERE j.session_uid = c.session_uid AND j.what = w.what) AS changed
    FROM vip.chosen c CROSS JOIN (VALUES ('gaze', 'gaze_kept'), ('sharing', 'data_shared')) w (what, code)) p;

-- Sessions of people who may stand in public exports: nobody who refused once, or was asked and did not
-- answer.
CREATE OR REPLACE VIEW vip.shareable AS
  SELECT c.* FROM vip.chosen c WHERE NOT EXISTS (
    SELECT 1 FROM vip.permission p WHERE p.person = c.person AND p.what = 'sharing' AND p.granted = 0);

-- Presentations whose gaze and head poses may be kept: gaze is allowed now, and was not refused after them.
CREATE OR REPLACE VIEW vip.gaze_showing AS
  SELECT s.session_uid, s.sender, s.presentation_id FROM (
    SELECT session_uid, sender, presentation_id,
      row_number() OVER (PARTITION BY session_uid, sender ORDER BY presentation_id) AS place
    FROM vip.presentation) s
  JOIN vip.permission p ON p.session_uid = s.session_uid AND p.sender = s.sender AND p.what = 'gaze'
    AND p.granted = 1
  WHERE NOT EXISTS (SELECT 1 FROM vip.joined_change j WHERE j.session_uid = s.session_uid AND j.what = 'gaze'
    AND j.granted = 0 AND coalesce(j.showings, s.place) >= s.place);

-- Sessions whose validations of the eye tracker may be kept: a validation belongs to no showing, so that any
-- refusal hides it.
CREATE OR REPLACE VIEW vip.gaze_session AS
  SELECT p.session_uid, p.sender FROM vip.permission p WHERE p.what = 'gaze' AND p.granted = 1
    AND NOT EXISTS (SELECT 1 FROM vip.joined_change j WHERE j.session_uid = p.session_uid AND j.what = 'gaze'
      AND j.granted = 0);

-- Deletes gaze of the caller's copy of a session that is refused.
CREATE OR REPLACE FUNCTION vip.drop_refused_gaze(uid text) RETURNS void
LANGUAGE sql VOLATILE SECURITY DEFINER SET search_path = pg_catalog, pg_temp AS $$
  DELETE FROM vip.gaze g WHERE g.session_uid = uid AND g.sender = session_user::text
    AND g.presentation_id NOT IN (SELECT w.presentation_id FROM vip.gaze_showing w
      WHERE w.session_uid = uid AND w.sender = session_user::text);
  DELETE FROM vip.head g WHERE g.session_uid = uid AND g.sender = session_user::text
    AND g.presentation_id NOT IN (SELECT w.presentation_id FROM vip.gaze_showing w
      WHERE w.session_uid = uid AND w.sender = session_user::text);
  DELETE FROM vip.gaze_validation g WHERE g.session_uid = uid AND g.sender = session_user::text AND NOT EXISTS
    (SELECT 1 FROM vip.gaze_session w WHERE w.session_uid = uid AND w.sender = session_user::text);
$$;

REVOKE ALL ON ALL FUNCTIONS IN SCHEMA vip FROM PUBLIC;
GRANT USAGE ON SCHEMA vip TO {station};
GRANT EXECUTE ON FUNCTION vip.withdrawn_among(text[]), vip.drop_refused_gaze(text) TO {station};
