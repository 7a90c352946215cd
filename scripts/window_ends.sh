#!/usr/bin/env bash
# Tests how a session ends before its last page, with real key and mouse events at the participant's window on
# a virtual screen. P01 refuses consent, P02 is excluded by screening, P03 stops during a stimulus and has all
# data deleted, and P04 stops during a rest and keeps the data. Also tests the experimenter's pause. Fails if
# a page, an exit status or the database is not as expected, or if a session gets stuck.
# usage: scripts/window_ends.sh [FOLDER]    default: out/window_ends
# Takes three minutes, because the rest after a stop is 60 s.
# Takes vip-study from $VIP_STUDY, else from build/dev. Pictures, database and logs go to FOLDER.
set -euo pipefail
cd "$(dirname "$0")/.."
out=${1:-out/window_ends}
study=${VIP_STUDY:-build/dev/bin/vip-study}
size=${VIP_SCREEN:-1280x720}

. scripts/window_lib.sh
db=$out/study.db
rm -f "$out"/study.db* "$out"/*.png "$out"/*.events "$out/keys"
bake_dam "$out/dam.bake"
screen_of "$out/screen" "$size"
DISPLAY=:$(cat "$out/screen")
export DISPLAY
# The demonstration protocol with one method, so that one bake holds all stimuli.
sed -e 's/^method = .*/method = ["HiRes"]/' -e 's/^order = "constrained".*/order = "shuffle"/' -e '/^never_adjacent/d' \
  protocols/demo.toml >"$out/protocol.toml"
mkfifo "$out/keys"
exec 3<>"$out/keys"  # the experimenter's keyboard

begin() {  # begin CODE: starts a person's session
  code=$1 events=$out/$1.events
  : >"$events"
  "$study" run "$out/protocol.toml" --db "$db" --participant "$code" --display window --station test --screen-width-mm 520 \
    --viewing-distance-mm 600 --stimulus "$out/dam.bake" --trial-seconds 2 --seed 3 --events --console <&3 >"$events" 2>"$out/$code.log" &
  session=$!
}
ended() {  # ended STATUS STATE: checks the exit status of the command and the state of the session
  local status=0
  for _ in $(seq 100); do alive || break; sleep 0.1; done
  ! alive || { shoot "${code}_stuck"; echo "window_ends: $code is stuck at: $(tail -n 1 "$events")" >&2; exit 1; }
  wait "$session" || status=$?
  session=
  expect "$code: exit status" "$1" "$status"
  expect "$code: state" "$2" "$(ask "select state from session where participant = '$code'")"
}
ask() { sqlite3 -cmd '.timeout 2000' "$db" "$1"; }
until_begins() {  # until_begins KIND: waits until a unit of this kind is shown and takes input
  local give_up=$((SECONDS + 60))
  until tail -n 1 "$events" | grep -q "^begins $code [0-9]* $1 "; do
    [ $SECONDS -lt $give_up ] && alive || { shoot "${code}_stuck"; echo "window_ends: $code: the session ended, or no $1 began within 60 s; see $events" >&2; exit 1; }
    sleep 0.05
  done
  sleep 0.6
}
# page NAME: waits for the next page, which ignores input in its first 300 ms, and stores a screenshot.
page() { sleep 0.6; shoot "${code}_$1"; }
welcome() { until_begins instructions; sleep 3; key Return; }
agree() { until_begins consent; key 1 Return; }
to_practice() {
  welcome; agree
  until_begins screening; key 0 Return
  until_begins demographics; key 3 0 Tab Tab; click_on
  until_begins fms; key Right Return Return
}

# The mouse rests where "yes" appears and must not highlight it. The first refusal is taken back as a mistake;
# the second refusal is confirmed.
begin P01
until_begins instructions
shoot P01_welcome
xdotool mousemove $((width * 30 / 100)) $((height * 513 / 1000))
sleep 3
key Return
until_begins consent
shoot P01_consent
expect "P01: a mouse that lies on yes does not light it" "70 71 75" "$(pixel $((width * 30 / 100)) $((height * 513 / 1000)))"
xdotool mousemove_relative 3 0
sleep 0.3
expect "P01: one that is moved there does" "90 92 97" "$(pixel $((width * 30 / 100)) $((height * 513 / 1000)))"
key 0 Return
page refusal_question
key 1 Return
page consent_again
key 0 Return
sleep 0.6
key 2 Return
page refused
expect "P01: answers kept" 0 "$(ask "select count(*) from response")"
key Return
ended 4 refused

begin P02
welcome; agree
until_begins screening; key 1 Return
page not_eligible
key Return
ended 4 "not eligible"

begin P03
to_practice
until_begins practice
until [ "$(ask "select count(*) from presentation where state = 'running'")" = 1 ]; do sleep 0.1; done
sleep 0.7
key Escape
page stop_question
key 2 Return
page over
sleep 61
key Return
page questionnaire_offered
key 1 Return
page questionnaire
key 2 Return; for _ in $(seq 15); do key Return; done
shoot P03_questionnaire_answered
key Return
page keep_or_delete
expect "P03: answers to the SSQ" "1 of 16" "$(ask "select sum(score is not null) || ' of ' || count(*) from response join unit using (unit_id) where kind = 'ssq'")"
key 2 Return
page deleted
key Return
ended 3 ""  # no state: the session was deleted from the database
expect "P03 is deleted" "1 tombstone, 0 sessions" "$(ask "select (select count(*) from tombstone where participant = 'P03') || ' tombstone, ' ||
  (select count(*) from session where participant = 'P03') || ' sessions'")"
expect "P03 in the personal file" 0 "$(sqlite3 "$db.personal" "select count(*) from personal where participant = 'P03'")"

begin P04
to_practice
until_begins practice
printf p >&3
until [ "$(ask "select count(*) from presentation join trial using (trial_id) join session using (session_id)
  where participant = 'P04' and presentation.state = 'played'")" = 1 ]; do sleep 0.1; done
sleep 1
for k in 5 Return 1 Return Return; do key "$k"; done
page paused
printf p >&3
until_begins rest
shoot P04_rest
key Escape
page stop_question
key 2 Return
sleep 61
key Return
sleep 0.6; key 2 Return  # declines the questionnaire
page keep_or_delete
key 1 Return
page kept
key Return
ended 3 stopped
expect "P04: answers stay" yes "$(ask "select iif(count(*) > 2, 'yes', 'no') from response join unit using (unit_id) join session using (session_id) where participant = 'P04'")"
expect "resume" "$db: nothing is left to do" "$("$study" resume --db "$db" | tail -n 1)"
again=$("$study" run "$out/protocol.toml" --db "$db" --participant P04 --display window --stimulus "$out/dam.bake" --trial-seconds 2 2>&1 || true)
case $again in
  *"it is over (stopped)"*) echo "ok      run says the same" ;;
  *) echo "FAILED  run says: $again"; failed=1 ;;
esac
exit $failed
