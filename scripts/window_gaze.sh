#!/usr/bin/env bash
# Tests the mouse as the source of gaze at the participant's window, with the real pointer on a virtual
# screen. Gaze must be recorded for a participant who allowed it, and not for one who refused.
# usage: scripts/window_gaze.sh [FOLDER]    default: out/window_gaze
# Takes vip-study from $VIP_STUDY, else from build/dev. Databases and logs go to FOLDER.
set -euo pipefail
cd "$(dirname "$0")/.."
out=${1:-out/window_gaze}
study=${VIP_STUDY:-build/dev/bin/vip-study}
size=${VIP_SCREEN:-1280x720}

. scripts/window_lib.sh
rm -f "$out"/study.db* "$out"/{events,log}_*
bake_dam "$out/dam.bake"
screen_of "$out/screen" "$size"
DISPLAY=:$(cat "$out/screen")
export DISPLAY

# The pilot at two frame rates, with a further consent question, which an observer answers with yes or no.
cat >"$out/box" <<'END'

[[block.question]]
id = "gaze_kept"
kind = "choice"
text = "Where I look may be recorded."
anchors = {0 = "no", 1 = "yes"}
END
sed -e "/^accept = /r $out/box" -e 's/^mean_fps = .*/mean_fps = [20, 50]/' -e 's/^sd_fps = .*/sd_fps = [0]/' \
  -e 's/"black 3", //' protocols/ptpe_pilot.toml >"$out/protocol.toml"

# session_of CODE OBSERVER: plays a session while the pointer moves to and fro over the picture
session_of() {
  xdotool mousemove $((width / 2)) $((height / 4))
  "$study" run "$out/protocol.toml" --db "$out/study.db" --participant "$1" --observer "$2" --display window --gaze mouse \
    --stimulus "$out/dam.bake" --trial-seconds 2 --events >"$out/events_$1" 2>"$out/log_$1" &
  session=$!
  while alive; do
    for at in 25 45 75; do  # not 50: GLFW placed the pointer at the centre and ignores a move to that pixel
      xdotool mousemove $((width * at / 100)) $((height / 2)) || true
      sleep 0.12  # long enough for a slow machine to record each position
    done
  done
  wait "$session" || { cat "$out/log_$1" >&2; failed=1; }
  session=
}
session_of P01 constant:1
session_of P02 constant:0

ask() { sqlite3 "$out/study.db" "$1"; }
expect_sql() { expect "$1" "$2" "$(ask "$3")"; }
of="from gaze join presentation using (presentation_id) join trial using (trial_id) join session using (session_id) where participant ="
expect_sql "presentations of each" "P01 2 P02 2" "select group_concat(participant || ' ' || n, ' ') from (select participant, count(*) as n from presentation join trial using (trial_id) join session using (session_id) where presentation.state = 'played' group by participant)"
expect_sql "gaze of who said yes" 1 "select count(*) > 20 $of 'P01'"
expect_sql "presentations with gaze" 2 "select count(distinct presentation_id) $of 'P01'"
expect_sql "marked as mouse and valid" 0 "select count(*) $of 'P01' and not (source = 'mouse' and valid = 1)"
expect_sql "where the pointer was" "0.25 0.45 0.75" "select group_concat(x, ' ') from (select distinct round(x, 2) as x $of 'P01' order by 1)"
expect_sql "within the presentation" 0 "select count(*) $of 'P01' and (sampled_ns < 0 or sampled_ns > end_ns - start_ns)"
expect_sql "gaze of who said no" 0 "select count(*) $of 'P02'"
"$study" consent P01 --db "$out/study.db" --gaze no >"$out/events_no"
expect_sql "gaze after the change" 0 "select count(*) from gaze"
echo "        $(grep deleted "$out/events_no")"
exit $failed
