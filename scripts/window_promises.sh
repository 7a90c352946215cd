# Checks what the files of a session at the window must hold after each of its processes, however the process
# ended. window_kills.sh sources this file and sets $study, $out, a function `fail WORDS`, and for each
# session: $name, $db, $cut (the showing that was under way when the last process ended; empty: none),
# $first_open (position of the first unit that is not done) and the files $out/$name.*.
# After a kill the database is read from a copy, so that the next process finds it as the kill left it.
copy() {
  rm -f "$out"/copy/*
  cp "$db"* "$out/copy/"
}
ask() { sqlite3 "$out/copy/$name.db" "$1"; }
ask_personal() { sqlite3 "$out/copy/$name.db.personal" "$1"; }
planned() { [ -s "$db" ] && copy && [ "$(ask "select count(*) from sqlite_schema where name = 'unit'")" = 1 ] && [ "$(ask "select count(*) from unit")" != 0 ]; }

wanted() { [ "$2" = "$3" ] || fail "$1: '$3' instead of '$2'"; }
none() { [ -z "$2" ] || fail "$1: $(echo "$2" | head -n 5 | tr '\n' ';')"; }
kept() {  # kept WHAT FILE ROWS: checks that all rows stored in FILE are among ROWS; then stores ROWS in FILE
  [ -e "$2" ] || : >"$2"
  echo "$3" | sed '/^$/d' | sort >"$2.now"
  none "$1 lost or changed" "$(comm -23 "$2" "$2.now")"
  mv "$2.now" "$2"
}

check() {  # checks the files of a session whose process has just ended, as this file's comments say
  "$study" status --db "$db" >"$out/$name.status" 2>&1 || fail "status: $(cat "$out/$name.status")"
  copy
  wanted integrity ok "$(ask "pragma integrity_check")"
  none "foreign keys" "$(ask "pragma foreign_key_check")"
  # The process showed no unit again that was already done, and it began with the first unit that was open.
  sed -n 's/^begins P01 \([0-9]*\) .*/\1/p' "$out/$name.events" >"$out/$name.begun"
  none "asked twice" "$(sort "$out/$name.begun" | comm -12 - <(sort "$out/$name.done"))"
  if [ -s "$out/$name.begun" ]; then wanted "goes on at" "$first_open" "$(head -n 1 "$out/$name.begun")"; fi
  # Every unit that was announced as done is stored as done. At most one unit is stored as done but not yet
  # announced.
  sed -n 's/^done P01 \([0-9]*\) .*/\1/p' "$out/$name.events" >>"$out/$name.said"
  ask "select position from unit where state = 'done'" >"$out/$name.done"
  none "announced and lost" "$(sort "$out/$name.said" | comm -23 - <(sort "$out/$name.done"))"
  none "announced twice" "$(sort "$out/$name.said" | uniq -d)"
  local untold
  untold=$(sort "$out/$name.done" | comm -23 - <(sort "$out/$name.said"))
  [ "$(echo "$untold" | wc -w)" -le 1 ] || fail "done and not announced: $untold"
  echo "$untold" | sed '/^$/d' >>"$out/$name.said"
  first_open=$(ask "select min(position) from unit where state <> 'done'")
  # Every answer stays as it was given, and no question of a unit has two answers.
  kept answers "$out/$name.answers" "$(ask "select * from response")"
  kept notes "$out/$name.log_events" "$(ask "select event_id, utc, kind from event")"
  if [ -e "$db.personal" ]; then
    wanted "integrity of the personal file" ok "$(ask_personal "pragma integrity_check")"
    if [ "$(ask_personal "select count(*) from sqlite_schema")" != 0 ]; then
      kept "personal answers" "$out/$name.personal_answers" "$(ask_personal "select * from personal")"
    fi
  fi
  none "answered twice" "$(ask "select unit_id, question_id from response group by 1, 2 having count(*) > 1")"
  none "done without an answer" "$(ask "select position from unit u where state = 'done' and trial_id is not null and
    (select count(*) from response r where r.unit_id = u.unit_id) <> 2")"
  # Only the newest showing may have the state "running": earlier showings that were cut must be marked.
  none "interrupted and not marked" "$(ask "select presentation_id from presentation where state = 'running' and
    presentation_id < (select max(presentation_id) from presentation)")"
  if [ -s "$out/$name.begun" ] && [ -n "$cut" ]; then
    wanted "the showing that was cut" interrupted "$(ask "select state from presentation where presentation_id = $cut")"
  fi
  if [ -z "$cut" ] || [ -s "$out/$name.begun" ]; then cut=$(ask "select presentation_id from presentation where state = 'running'"); fi
  none "attempts skipped" "$(ask "select trial_id from presentation group by 1 having count(*) <> max(attempt)")"
}

check_whole() {
  copy
  wanted "units left" 0 "$(ask "select count(*) from unit where state <> 'done'")"
  wanted "the session" done "$(ask "select state from session")"
  wanted "answers to each question" "1 1 $1 $1 1" "$(ask "select group_concat(n, ' ') from (select count(*) n from response
    join question using (question_id) group by code order by code = 'remark', code = 'smoothness', code = 'satisfaction', code = 'take_part')")"
  wanted "the personal answer" 30 "$(ask_personal "select answer from personal where question = 'age'")"
  wanted "showings under way" 0 "$(ask "select count(*) from presentation where state = 'running'")"
  none "interrupted and not shown again" "$(ask "select trial_id from presentation p where state = 'interrupted' and
    not exists (select 1 from presentation q where q.trial_id = p.trial_id and q.attempt > p.attempt and q.state = 'played')")"
  none "judged a showing that was cut" "$(ask "select unit_id from response r join unit u using (unit_id)
    join presentation p on p.trial_id = u.trial_id and p.attempt = r.attempt where p.state <> 'played'")"
}
