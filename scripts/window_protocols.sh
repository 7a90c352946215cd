#!/usr/bin/env bash
# Plays complete sessions of protocols at the participant's window, from consent to the last page, with real
# key and mouse events on a virtual screen. Then checks that the database and the exports contain everything;
# fails if not.
# usage: scripts/window_protocols.sh [--out FOLDER] [PROTOCOL ...]
#        default: out/window_protocols, and ptpe_pilot task1 task2 task2_lab
# Takes vip-study from $VIP_STUDY, else from build/dev. Pictures, database, exports and logs go to FOLDER/PROTOCOL.
#
# The protocols are shortened, so that a session takes two to four minutes on two cores. Live fluid has 64 or
# 128 as n_* (number of particles if all are coarsest) and stimuli of 0.3 s, which the processor draws in a
# third of a second for each frame. The pilot plays a bake, with stimuli of 1.5 s. Rests of 30 and 60 s are
# cut to 2 s, black pauses of 5 s to 1 s, and the two minutes between scenes to 3 s. Units, questions, other
# pauses and shortest reading times are unchanged.
set -euo pipefail
cd "$(dirname "$0")/.."
folder=out/window_protocols
[ "${1:-}" != --out ] || { folder=$2; shift 2; }
[ $# -gt 0 ] || set -- ptpe_pilot task1 task2 task2_lab
if [ $# -gt 1 ]; then
  status=0
  for protocol; do "$0" --out "$folder" "$protocol" || status=1; done
  exit $status
fi
protocol=$1
out=$folder/$protocol
study=${VIP_STUDY:-build/dev/bin/vip-study}
size=${VIP_SCREEN:-800x450}
. scripts/window_lib.sh
db=$out/study.db
rm -rf "$out"/study.db* "$out"/*.png "$out"/{csv,bids,psych-ds} "$out"/{events,log,given}
sed -e 's/"16k"/"64"/; s/"32k"/"128"/' -e '/^n_star/s/"32k"/"128"/' -e 's/"rest [0-9]*"/"rest 2"/' -e 's/"black 5"/"black 1"/g' \
  -e 's/^between_groups_s = [0-9]*/between_groups_s = 3/' "protocols/$protocol.toml" >"$out/$protocol.toml"

seconds=0.3 stimulus=()
if [ "$protocol" = ptpe_pilot ]; then
  bake_dam "$folder/dam.bake"
  seconds=1.5 stimulus=(--stimulus "$folder/dam.bake")
fi

screen_of "$out/screen" "$size"
DISPLAY=:$(cat "$out/screen")
export DISPLAY
begun=$SECONDS
"$study" run "$out/$protocol.toml" --db "$db" --participant P01 --display window --gaze mouse --station test \
  --screen-width-mm 520 --viewing-distance-mm 600 --trial-seconds "$seconds" "${stimulus[@]}" --seed 5 --events --accept-slow \
  >"$out/events" 2>"$out/log" </dev/null &
session=$!

ask() { sqlite3 -cmd '.timeout 2000' "$db" "$1"; }
# True if a page is shown: both ends of its button then have the same grey, which is one of three (the button
# waits, can be pressed, or is under the mouse).
page_is_on() {
  local half=$((height * 110 / 1000)) ends
  ends=$(import -window root -crop "$((2 * half + 1))x1+$((width / 2 - half))+$button_y" -depth 8 rgb:- |
    od -An -v -tu1 -w3 | sed -n '1p;$p' | tr -s ' ' | uniq)
  case $ends in " 48 48 51" | " 70 71 75" | " 90 92 97") true ;; *) false ;; esac
}

# Prints the answer to a question. Questions with one acceptable answer are listed by code; the answers to
# others differ from unit to unit.
answer_to() {  # answer_to CODE POSITION PLACE MIN MAX
  case $1 in
    take_part | acuity | data_shared) echo 1 ;;
    guardian | attention_check) echo 2 ;;
    epilepsy | balance) echo 0 ;;
    age) echo 34 ;;
    ipd_mm) echo 63 ;;
    fms) echo $(($2 % 4)) ;;
    *) echo $(($4 + (3 * $2 + $3) % ($5 - $4 + 1))) ;;
  esac
}

give() {  # give KIND MAX ANSWER: answers the question that has the focus, and moves on to the next question
  local i
  if [ "$1" != number ] && [ "$2" -gt 9 ]; then  # scores of two digits: chosen by arrow keys from the lowest
    for ((i = 0; i <= $3; ++i)); do key Right; done
    key Return
  else
    for ((i = 0; i < ${#3}; ++i)); do key "${3:i:1}"; done
  fi
}

picture_once() {  # picture_once NAME: waits half a second and stores a screenshot, only once for each NAME
  case $pictured in *" $1 "*) return 0 ;; esac
  pictured+=" $1 "
  sleep 0.5
  shoot "$(printf '%02d_%s' "$position" "$1")"
}
confirm() { if [ $((position % 2)) = 0 ]; then click_on; else key Return; fi; }
stuck() { shoot stuck; echo "window_protocols: $protocol is stuck at unit $position ($kind $block)${1:+, $1}" >&2; exit 1; }

# A trial has one page for each "ask" step of its protocol.
mapfile -t asks < <(sed -n '/^steps = /s/"/\n/gp' "$out/$protocol.toml" | sed -n 's/^ask //p')

answer_page() {  # answer_page CODES: answers a page of the unit; CODES: its questions, for SQL; empty: all
  local code what least most personal place=0 answer count=0 name
  name=$(printf '%02d_%s_%s' "$position" "$kind" "${1:+$page}")
  sleep 0.4  # a page ignores input in its first 300 ms
  local first=
  case $pictured in *" $kind$page "*) ;; *) first=yes pictured+=" $kind$page " ;; esac
  [ -z "$first" ] || shoot "$name"
  mapfile -t questions < <(ask "select code, kind, scale_min, scale_max, personal, place from ask join question using (question_id)
    where block = '$block' ${1:+and code in ($1)} order by place")
  for question in "${questions[@]}"; do
    IFS='|' read -r code what least most personal place <<<"$question"
    answer=$(answer_to "$code" "$position" "$place" "$least" "$most")
    [ "$personal" = 1 ] || { wanted=$((wanted + 1)); echo "$position|$code|$answer" >>"$out/given"; }
    give "$what" "$most" "$answer"
    count=$((count + 1))
    [ ${#questions[@]} = 1 ] || key Return
  done
  [ -z "$first" ] || [ $count = 0 ] || shoot "${name}_answered"
  local waited=0 tries=0
  until settled; do
    [ $((waited % 8)) != 0 ] || { [ $((++tries)) -le 12 ] || stuck "page $page"; confirm; }
    waited=$((waited + 1))
    sleep 0.1
  done
}
# True if the answers to the page are in the database (in a trial), or if the unit is done (outside trials).
settled() {
  if [ "$trial" = 1 ]; then
    [ "$(ask "select count(*) from response join unit using (unit_id) where position = $position")" -ge "$wanted" ]
  else
    [ "$(ask "select state from unit where position = $position")" = done ]
  fi
}

position=-1 page=0 pages=1 trial=0 wanted=0 kind='' block='' pictured=' ' stimuli=0
moved=$SECONDS
while alive; do
  [ $((SECONDS - moved)) -lt 300 ] || stuck
  read -r what _ at now_kind now_block < <(tail -n 1 "$out/events" 2>/dev/null; echo) || true
  if [ "${what:-}" != begins ]; then  # between two units; if trials end with a rest, the rest is shown now
    [ "$trial" = 0 ] || ! grep -q '^steps = .*"rest ' "$out/$protocol.toml" || picture_once rest
    sleep 0.1
    continue
  fi
  if [ "$at" != "$position" ]; then
    position=$at kind=$now_kind block=$now_block page=0 pages=1 wanted=0 moved=$SECONDS
    trial=$(ask "select trial_id is not null from unit where position = $position")
    [ "$trial" = 0 ] || pages=${#asks[@]}
    [ "$trial" = 0 ] || ! grep -q '^pairs = true' "$out/$protocol.toml" || picture_once word
    if [ "$trial" = 0 ] && [ "$kind" = stimulus ]; then  # the pause between two groups, which asks nothing
      kind=break block=
      picture_once break_countdown
    fi
  fi
  if [ "$trial" = 1 ] && [ "$stimuli" -lt 2 ] &&
    [ "$(ask "select count(*) from presentation where state = 'running'")" = 1 ] && [ "$(pixel $((width / 2)) $((height / 2)))" != "0 0 0" ]; then
    stimuli=$((stimuli + 1))
    shoot "$(printf '%02d_stimulus_%d' "$position" "$stimuli")"
    continue
  fi
  if [ "$page" -lt "$pages" ] && page_is_on; then
    if [ "$trial" = 1 ]; then answer_page "'${asks[page]// /\',\'}'"; else answer_page ""; fi
    page=$((page + 1)) moved=$SECONDS
  else
    sleep 0.2
  fi
done
status=0
wait "$session" || status=$?
session=
cat "$out/log" >&2
[ $status -eq 0 ] || { echo "window_protocols: vip-study ended with $status" >&2; exit 1; }
echo "        $protocol took $((SECONDS - begun)) s"

# Compares the database with the numbers of units and trials that vip-study check predicts.
plan=$("$study" check "$out/$protocol.toml" --refresh 60 2>/dev/null | sed -n 's/^plan: //p')
units=${plan%% units*}
trials=${plan#*, }
trials=${trials%% trials*}
shown=$trials
! grep -q '^pairs = true' "$out/$protocol.toml" || shown=$((2 * trials))
expect "session" done "$(ask "select state from session")"
expect "units" "$units" "$(ask "select count(*) from unit")"
expect "units done" "$units" "$(ask "select count(*) from unit where state = 'done'")"
expect "trials answered" "$trials" "$(ask "select count(*) from trial where state = 'answered'")"
# The break between two groups is a unit of the trials' block that asks nothing.
expect "questions without an answer" 0 "$(ask "select count(*) from unit u join ask a using (block) join question q using (question_id)
  where not q.personal and not (u.kind = 'stimulus' and u.trial_id is null)
  and not exists (select 1 from response r where r.unit_id = u.unit_id and r.question_id = q.question_id
  and (r.score is not null or r.words is not null))")"
ask "select u.position, q.code, r.score from response r join unit u using (unit_id) join question q using (question_id)
  join ask a on a.block = u.block and a.question_id = q.question_id order by u.position, a.place" >"$out/kept"
expect "answers other than those given" "" "$(diff "$out/given" "$out/kept" | head -n 5)"
expect "answers" "$(wc -l <"$out/given")" "$(ask "select count(*) from response")"
personal=$(ask "select count(distinct code) from question where personal")
if [ "$personal" -gt 0 ]; then
  expect "personal answers in their own file" "$personal" "$(sqlite3 "$db.personal" "select count(*) from personal")"
  expect "age in that file" 34 "$(sqlite3 "$db.personal" "select answer from personal where question = 'age'")"
fi
expect "stimuli played" "$shown" "$(ask "select count(*) from presentation where state = 'played' and attempt = 1")"
expect "stimuli cut or shown again" 0 "$(ask "select count(*) from presentation where state <> 'played' or attempt > 1")"
verdicts=$shown
! grep -q '^timing = "native"' "$out/$protocol.toml" || verdicts=0
expect "verdicts" "$verdicts" "$(ask "select count(*) from presentation where verdict is not null")"
expect "stimuli whose frames are not all kept" 0 "$(ask "select count(*) from presentation p
  where frames is null or frames = 0 or frames <> (select count(*) from frame f where f.presentation_id = p.presentation_id)")"
expect "gaze source" mouse "$(ask "select gaze_source from session")"
echo "        verdicts on this machine: $(ask "select group_concat(n, ', ') from (select count(*) || ' ' || verdict as n from presentation group by verdict)")"

"$study" export --db "$db" --csv "$out/csv" --bids "$out/bids" --psych-ds "$out/psych-ds" >"$out/export_log"
rows() { if [ -f "$1" ]; then echo $(($(wc -l <"$1") - 1)); else echo "no file ${1##*/}"; fi; }
for table in unit response presentation frame trial; do
  expect "rows of ${table}s.csv" "$(ask "select count(*) from $table")" "$(rows "$out/csv/${table}s.csv")"
done
in_trials=$(ask "select count(*) from response join unit using (unit_id) where trial_id is not null")
on_pages=$(ask "select count(*) from response join unit using (unit_id) where trial_id is null")
expect "stimuli in BIDS" "$shown" "$(rows "$(find "$out/bids" -name '*_events.tsv')")"
expect "participants in BIDS" 1 "$(rows "$out/bids/participants.tsv")"
for block in $(ask "select distinct kind from unit join response using (unit_id) where trial_id is null and kind in ('ssq', 'consent', 'screening')"); do
  table=$out/bids/phenotype/$block.tsv
  expect "people of $block in BIDS" 1 "$(rows "$table")"
  [ "$block" != ssq ] || expect "times of ssq in BIDS" "$(ask "select count(*) from unit where kind = 'ssq'")" \
    "$(head -n 1 "$table" | tr '\t' '\n' | grep -c '_total$')"
done
expect "answers to trials in Psych-DS" "$in_trials" "$(rows "$(find "$out/psych-ds/data" -name '*v1_data.csv')")"
expect "answers on pages in Psych-DS" "$on_pages" "$(rows "$(find "$out/psych-ds/data" -name '*pages_data.csv')")"
"$study" consent P01 --db "$db" --sharing no >>"$out/log"
"$study" export --db "$db" --bids "$out/bids-refused" --psych-ds "$out/psych-ds-refused" >>"$out/export_log"
expect "files of P01 in public exports once sharing is refused" 0 \
  "$(grep -rlE 'sub-P01|P01' "$out/bids-refused" "$out/psych-ds-refused" | wc -l)"
expect "unfinished files" 0 "$(find "$out" -name '*.tmp*' | wc -l)"
said=$("$study" status --db "$db" | grep P01 | tr -s ' ' | sed 's/ [a-z]* clock.*//; s/^ //')
expect "status" "P01 visit 1 $trials of $trials trials, $units of $units steps, 0 cut short, 0 excluded complete" "$said"
expect "resume" "$db: nothing is left to do" "$("$study" resume --db "$db" | tail -n 1)"
exit $failed
