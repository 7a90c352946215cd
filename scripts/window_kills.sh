#!/usr/bin/env bash
# Kills a person's session at the window with SIGKILL at KILLS random instants and resumes it after each kill.
# SEED is the seed of the random numbers. Then lets the disk fill in the middle of a trial of another session.
# Real key and mouse events on a virtual screen answer the pages. Fails if an answer is lost or asked for
# twice, if a trial that was cut is not marked and shown again, or if the database is damaged.
# usage: scripts/window_kills.sh [FOLDER [KILLS [SEED]]]    default: out/window_kills 50 1
# Takes vip-study from $VIP_STUDY, else from build/dev. Databases, events and logs go to FOLDER.
set -euo pipefail
cd "$(dirname "$0")/.."
out=${1:-out/window_kills} kills=${2:-50} seed=${3:-1}
study=${VIP_STUDY:-build/dev/bin/vip-study}
size=${VIP_SCREEN:-800x450}

. scripts/window_lib.sh
. scripts/window_promises.sh
mkdir -p "$out/copy"
rm -f "$out"/{kills,full}.* "$out"/copy/*
export LC_ALL=C
bake_dam "$out/dam.bake"
screen_of "$out/screen" "$size"
DISPLAY=:$(cat "$out/screen")
export DISPLAY

failures=0
fail() { echo "FAILED  $name, $stage: $*"; failures=$((failures + 1)); }

write_protocol() {  # write_protocol FILE MEANS SECONDS: trials and each kind of page that stores an answer
  cat >"$1" <<END
format = 2
name = "$name"
version = "1"
language = "en"
participants = 1
accept_approximate = true

[design]
scene = ["data/scenes/single_dam.toml"]
method = ["HiRes"]
n_star = ["512"]
timing = "settings"
mean_fps = [$2]
sd_fps = [0, 3]
duration_s = $3
order = "shuffle"

[pacing]
mean = "harmonic"
fps_min = 4
max_interval_ms = 250
order = "white"

[content]
mode = "per_frame"
content_step_s = 0.016666666666666666
start_frame = 0
at_end = "loop"

[[block]]
kind = "instructions"
id = "welcome"
text = "You will see water."

[[block]]
kind = "consent"
id = "consent"
text = "A test."

[[block.question]]
id = "take_part"
kind = "choice"
text = "I would like to go on."
anchors = {0 = "no", 1 = "yes"}
accept = [1, 1]

[[block]]
kind = "demographics"
id = "person"

[[block.question]]
id = "age"
kind = "number"
text = "Your age in years"
scale = [10, 110]
personal = true

[[block]]
kind = "fms"
id = "sickness"

[[block]]
kind = "practice"
id = "warm_up"
like = "ratings"
count = 1

[[block]]
kind = "stimulus"
id = "ratings"
steps = ["black 0.3", "stimulus", "ask satisfaction smoothness"]

[[block.question]]
id = "satisfaction"
kind = "scale"
text = "How satisfied are you with the motion of the fluid?"
scale = [1, 7]

[[block.question]]
id = "smoothness"
kind = "choice"
text = "Was it smooth?"
anchors = {0 = "no", 1 = "yes"}

[[block]]
kind = "question"
id = "remarks"

[[block.question]]
id = "remark"
kind = "text"
text = "Is there anything you would like to say?"

[[block]]
kind = "debrief"
id = "thanks"
text = "That was all."
END
}

# A key is lost while there is no window, as a person's key would be. The unit is then answered again.
key() { for k in "$@"; do xdotool key "$k" || true; sleep 0.06; done; }
# Clicks the button to go on (window_lib.sh).
click_on() {
  xdotool mousemove $((width / 2)) "$button_y" || true
  sleep 0.06
  xdotool click 1 || true
  sleep 0.08
}

answer() {  # answer KIND: answers a unit of this kind once; called again until the unit is over
  case $1 in
    instructions | debrief) click_on; key Return ;;
    consent) key 1 Return ;;
    demographics) key BackSpace BackSpace BackSpace BackSpace 3 0 Tab; click_on ;;
    fms) key Right Return Return ;;
    practice | stimulus) key 5 Return 1 Return ;;
    question) key w a t e r Tab Return ;;
  esac
}

start() {  # start COMMAND ...: starts a process of the session, whose events go to a new file
  : >"$out/$name.events"
  "$study" "$@" --db "$db" --events >"$out/$name.events" 2>"$out/$name.log" &
  session=$!
}
start_run() {
  start run "$out/$name.toml" --participant P01 --display window --gaze mouse --station test --screen-width-mm 520 \
    --viewing-distance-mm 600 --stimulus "$out/dam.bake" --seed "$seed"
}
sit() {  # sit SECONDS: answers pages until the process ends, and kills it after SECONDS; sets `ended` to its exit status
  local until=$((SECONDS + $1)) what kind
  while alive; do
    if [ $SECONDS -ge $until ]; then
      fail "stuck at: $(tail -n 1 "$out/$name.events")"
      kill -9 "$session"
      break
    fi
    read -r what _ _ kind _ < <(tail -n 1 "$out/$name.events"; echo) || true
    if [ "$what" = begins ]; then answer "$kind"; fi
    sleep 0.1
  done
  ended=0
  wait "$session" 2>/dev/null || ended=$?
}
new_session() {
  name=$1 stage=start db=$out/$1.db cut= first_open=0
  : >"$out/$name.done"
  : >"$out/$name.said"
}

begun=$SECONDS
new_session kills
write_protocol "$out/kills.toml" "$(seq -s , 20 $((20 + (kills + 2) / 3)))" 1.2
RANDOM=$seed
for ((kill = 1; kill <= kills; ++kill)); do
  stage="kill $kill"
  life_ms=$((RANDOM % 5000))
  if planned; then start resume; else start_run; fi
  # The kill comes from a separate process, so that it can fall anywhere: between two keys, within a trial, or
  # while a file is opened.
  (sleep "$((life_ms / 1000)).$(printf %03d $((life_ms % 1000)))"; exec kill -9 "$session") 2>/dev/null &
  killer=$!
  sit 60 2>/dev/null  # hides the shell's message about the kill
  kill "$killer" 2>/dev/null || true
  wait "$killer" 2>/dev/null || true
  if [ "$ended" -ne 137 ]; then
    fail "ended with $ended before it was killed: $(tail -n 3 "$out/kills.log")"
    break
  fi
  if planned; then check; elif [ -s "$out/kills.said" ] || grep -q '^done' "$out/kills.events"; then fail "the plan is lost"; fi
  printf 'kill %2d after %4d ms at: %s\n' "$kill" "$life_ms" "$(tail -n 1 "$out/kills.events")"
done
stage=end
if planned; then start resume; else start_run; fi
sit 400
wanted "exit status of the last resume" 0 "$ended"
check
trials=$(ask "select count(*) from trial")
check_whole "$trials"
cuts=$(ask "select count(*) from presentation where state = 'interrupted'")
[ "$kills" -lt 20 ] || [ "$cuts" -gt 0 ] || fail "no kill fell within a stimulus; take another seed"
[ $failures -ne 0 ] || echo "ok      $kills kills in $((SECONDS - begun)) s: $(ask "select count(*) from unit") steps, $trials trials, \
$(ask "select count(*) from response") answers; $cuts showings cut, with \
$(ask "select count(*) from frame join presentation using (presentation_id) where state = 'interrupted'") frames kept"

# Simulates a disk that fills in the middle of a trial: the database may grow by only three pages, but the
# frames of eight seconds need more.
new_session full
write_protocol "$out/full.toml" "60" 8
start_run
until grep -q '^begins' "$out/full.events" || ! alive; do sleep 0.1; done
kill -TERM "$session"
sit 30
copy
start resume --max-pages $(($(ask "pragma page_count") + 3))
sit 120
stage="full disk"
wanted "exit status" 1 "$ended"
grep -q "no room left" "$out/full.log" && grep -q "vip-study resume" "$out/full.log" || fail "no clear error: $(tail -n 3 "$out/full.log")"
check
said=$(grep -c . "$out/full.said" || true)
wanted "it was full within" "trial" "$(tail -n 1 "$out/full.events" | sed -E 's/begins P01 [0-9]+ (practice|stimulus) .*/trial/')"
[ -n "$cut$(ask "select presentation_id from presentation where state = 'interrupted'")" ] || fail "no showing was cut"
stage=end
start resume
sit 120
wanted "exit status of the resume" 0 "$ended"
check
check_whole "$(ask "select count(*) from trial")"
[ $failures -ne 0 ] || echo "ok      a full disk within a trial: clear error, $said steps kept, resume goes on to the end"
[ $failures -eq 0 ]
