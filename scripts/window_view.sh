#!/usr/bin/env bash
# Tests vip-view's panel with real key events on a virtual screen: the schedule (the list of the solver's
# passes) is shown and hidden, and effects are turned off and on while the fluid runs. Fails if a picture or a
# printed line is not as expected.
# usage: scripts/window_view.sh [FOLDER]    default: out/window_view. Takes half a minute.
# Takes vip-view from $VIP_VIEW, else from build/dev. Pictures and logs go to FOLDER.
set -euo pipefail
cd "$(dirname "$0")/.."
out=${1:-out/window_view}
view=${VIP_VIEW:-build/dev/bin/vip-view}
size=${VIP_SCREEN:-1280x720}

. scripts/window_lib.sh
rm -f "$out"/*.{png,log,toml}
screen_of "$out/screen" "$size"
DISPLAY=:$(cat "$out/screen")
export DISPLAY
# The splash scene with two further effects.
{ cat data/scenes/splash.toml; printf '\n[[effect]]\nkind = "cohesion"\ntension_n_m = 50.0\n\n[[effect]]\nkind = "adhesion"\nwork_n_m = 20.0\n'; } >"$out/scene.toml"

stdbuf -oL "$view" "$out/scene.toml" --method Ours --n-star 64 --backend cpu --size "$size" >"$out/view.log" 2>&1 &
session=$!
until_line() {  # until_line PATTERN: waits until a line of the log matches
  local give_up=$((SECONDS + 60))
  until grep -q "$1" "$out/view.log"; do
    [ $SECONDS -lt $give_up ] && alive || { shoot stuck; cat "$out/view.log" >&2; echo "window_view: no line of $out/view.log matches $1" >&2; exit 1; }
    sleep 0.1
  done
  sleep 0.6
}
last() { tail -n 1 "$out/view.log" | sed "s/^frame [0-9]*: //"; }
frame() { tail -n 1 "$out/view.log" | sed -n 's/^frame \([0-9]*\): .*/\1/p'; }
# Prints what the upper right corner shows: the dark head of the schedule, the bright sky of the room, or
# nothing (before the first picture).
corner() { read -r red _ blue <<<"$(pixel $((width - 60)) 20)" && if [ "$red" -gt 100 ]; then echo room; elif [ "$blue" -gt 5 ]; then echo schedule; else echo nothing; fi; }
until_corner() {  # until_corner WANTED: waits until the corner shows WANTED, at most ten seconds
  local give_up=$((SECONDS + 10))
  until [ "$(corner)" = "$1" ] || [ $SECONDS -ge $give_up ]; do sleep 0.3; done
}

until_line "particles on cpu"
until_corner room
expect "before a key" room "$(corner)"
key t
until_corner schedule
expect "the schedule is shown" schedule "$(corner)"
key 1
until_line "with cohesion, adhesion$"
without=$(last) at=$(frame)
key 1
until_line "with air_drag, cohesion, adhesion$"
all=$(last)
expect "a pass more" $(($(echo "$without" | cut -d' ' -f1) + 1)) "$(echo "$all" | cut -d' ' -f1)"
expect "the water went on" 1 $(($(frame) > at))
key 2
until_line "with air_drag$"
sleep 1
shoot without_cohesion
expect "what needs the effect falls with it" "with air_drag" "$(last | sed 's/.*passes, //')"
key t
until_corner room
expect "the schedule is closed" room "$(corner)"
kill "$session"
wait "$session" || true
session=
exit $failed
