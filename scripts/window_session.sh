#!/usr/bin/env bash
# Plays a whole session at the participant's window; real key and mouse events on a virtual screen answer it.
# Fails if the database lacks an answer.
# usage: scripts/window_session.sh [FOLDER]    default: out/window_session
# Takes vip-study from $VIP_STUDY, else from build/dev. Screenshots, database and logs go to FOLDER.
set -euo pipefail
cd "$(dirname "$0")/.."
out=${1:-out/window_session}
study=${VIP_STUDY:-build/dev/bin/vip-study}
size=${VIP_SCREEN:-1280x720}

. scripts/window_lib.sh
rm -f "$out"/study.db* "$out"/*.png "$out"/{events,keys}
bake_dam "$out/dam.bake"
screen_of "$out/screen" "$size"
DISPLAY=:$(cat "$out/screen")
export DISPLAY

# The demonstration protocol with one method, so that one bake holds all stimuli.
sed -e 's/^method = .*/method = ["HiRes"]/' -e 's/^order = "constrained".*/order = "shuffle"/' -e '/^never_adjacent/d' \
  protocols/demo.toml >"$out/protocol.toml"

mkfifo "$out/keys"
exec 3<>"$out/keys"  # the experimenter's keyboard
"$study" run "$out/protocol.toml" --db "$out/study.db" --participant P01 --display window --gaze mouse \
  --station test --screen-width-mm 520 --viewing-distance-mm 600 --stimulus "$out/dam.bake" --trial-seconds 2 \
  --seed 3 --events --console <&3 >"$out/events" 2>"$out/log" &
session=$!
# True if the same unit is still shown. Checked before each key, so that no key reaches the next page, which
# accepts keys after 300 ms.
still_on() { [ "$(under_way)" = "begins P01 $position $kind $id" ]; }
answer() {  # answer KIND ID: answers a unit of this kind once; called again until the unit is over
  case $1 in
    instructions | debrief)
      click_on
      key Return ;;
    consent) key 1 Return ;;
    screening) key 0 Return ;;
    demographics)
      key 3 0
      shoot demographics
      key Tab
      xdotool type --delay 20 "Waves and splashes"
      key Tab
      click_on ;;
    fms) key Right Return Return ;;
    practice | stimulus | repeat)  # these keys have no effect while the stimulus is shown
      for k in 5 Return 1 Return; do still_on && key "$k"; done
      [ "$1" != practice ] || shoot trial_answers
      still_on && click_on ;;
    catch) key 2 Return ;;
    ssq)
      key 1 Return 0 Return 3 Return
      shoot ssq_under_way
      for _ in $(seq 13); do key 0 Return; done
      key Return ;;
    question)
      xdotool type --delay 20 "It was pleasant"
      key Tab Return ;;
    break) key space ;;
    *) sleep 0.3 ;;
  esac
}

under_way() { tail -n 1 "$out/events" 2>/dev/null || true; }
shot=
give_up=$((SECONDS + 600))
while alive; do
  [ $SECONDS -lt $give_up ] || { shoot stuck; echo "window_session: stuck at: $(under_way)" >&2; exit 1; }
  read -r what _ position kind id < <(under_way; echo) || true
  [ "$what" = begins ] || { sleep 0.1; continue; }
  sleep 0.45  # a page ignores input in its first 300 ms
  if [ "$shot" != "$position" ]; then
    shot=$position
    shoot "$(printf '%02d_%s_%s' "$position" "$kind" "$id")"
    case $kind in
      rest) printf 'nthe door opened\n' >&3 ;;
      break) printf 'xsomebody spoke\nm' >&3 ;;
      ssq) printf 'rthe picture froze\n' >&3 ;;
    esac
    if [ "$kind" = repeat ]; then
      sleep 1.8
      shoot stimulus
    elif [ "$kind" = practice ]; then
      sleep 1.7
      key Escape  # interrupts the stimulus; after "go on" the trial is shown again
      sleep 0.6
      shoot stop_question
      key 1 Return
    fi
  fi
  answer "$kind" "$id" || true
done
status=0
wait "$session" || status=$?
session=
cat "$out/log" >&2
[ $status -eq 0 ] || { echo "window_session: vip-study ended with $status" >&2; exit 1; }

ask() { sqlite3 "$out/study.db" "$1"; }
expect_sql() { expect "$1" "$2" "$(ask "$3")"; }
expect_sql "units left" 0 "select count(*) from unit where state <> 'done'"
expect_sql "trials without an answer" 0 "select count(*) from trial t where not exists (select 1 from unit u join response r using (unit_id) where u.trial_id = t.trial_id)"
expect_sql "session is done" done "select state from session"
expect_sql "gaze source" mouse "select gaze_source from session"
expect_sql "answers to SSQ" 16 "select count(*) from response join unit using (unit_id) where kind = 'ssq'"
expect_sql "first answers to SSQ" "1 0 3" "select group_concat(score, ' ') from (select score from response join unit using (unit_id) where kind = 'ssq' order by response_id limit 3)"
expect_sql "attention" 2 "select score from response join unit using (unit_id) where kind = 'catch'"
expect_sql "remark" "It was pleasant" "select words from response join unit using (unit_id) where kind = 'question'"
expect_sql "presentations without a verdict" 0 "select count(*) from presentation where state = 'played' and verdict is null"
expect_sql "cut by the question whether to stop" 1 "select count(*) from presentation where state = 'interrupted'"
expect_sql "note" 1 "select count(*) from note where words like '%the door opened'"
expect_sql "excluded trials" 1 "select count(*) from trial where excluded = 'somebody spoke'"
expect_sql "shown again at the end" 1 "select count(*) from presentation where attempt > 1 and state = 'played' and trial_id = (select trial_id from unit where trial_id is not null order by position desc limit 1)"
expect_sql "revealing is logged" 1 "select count(*) from event where kind = 'setting revealed'"
expect_sql "pre-flight list is kept" 1 "select count(*) from event where kind = 'preflight'"
expect_sql "personal answers in the database" 0 "select count(*) from response where words like '%splashes%'"
personal=$(sqlite3 "$out/study.db.personal" "select group_concat(answer, ';') from (select * from $(sqlite3 "$out/study.db.personal" "select name from sqlite_master where type = 'table' limit 1") order by question)" || true)
case $personal in
  *30*Waves*) echo "ok      personal answers stand in their own file" ;;
  *) echo "FAILED  personal file holds: $personal"; failed=1 ;;
esac

# A display is lost in the middle of a trial; the session is then resumed on another display.
rm -f "$out"/lost.db* "$out/lost_events"
screen_of "$out/screen" 800x600
DISPLAY=:$(cat "$out/screen") "$study" run "$out/protocol.toml" --db "$out/lost.db" --participant P02 --observer random \
  --display window --size 640x360 --stimulus "$out/dam.bake" --trial-seconds 4 --events >"$out/lost_events" 2>"$out/lost_log" &
session=$!
until grep -qs 'begins .* stimulus' "$out/lost_events" || ! alive; do sleep 0.1; done
sleep 4
kill -9 "$screen"
status=0
wait "$session" || status=$?
session=
[ $status -eq 1 ] && grep -q "the connection to the X server is lost" "$out/lost_log" || { echo "FAILED  no clear error"; cat "$out/lost_log"; failed=1; }
lost() { sqlite3 "$out/lost.db" "$1"; }
answers=$(lost "select count(*) from response")
[ "$(lost "select state from presentation order by presentation_id desc limit 1")" = interrupted ] ||
  { echo "FAILED  the cut trial is not marked"; failed=1; }
screen_of "$out/screen" 800x600
DISPLAY=:$(cat "$out/screen") "$study" resume --db "$out/lost.db" >>"$out/lost_events" 2>>"$out/lost_log" || failed=1
kill "$screen"
echo "        $answers answers before the display was lost, $(lost "select count(*) from response") in the end"
[ "$(lost "select count(*) from unit where state <> 'done'")" = 0 ] || { echo "FAILED  resume left something"; failed=1; }
[ "$(lost "select max(attempt) from presentation")" = 2 ] || { echo "FAILED  the cut trial was not shown again"; failed=1; }
[ "$failed" -ne 0 ] || echo "ok      a lost display: nothing is lost, resume goes on"
exit $failed
