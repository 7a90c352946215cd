# Functions that the scripts window_*.sh share: a virtual screen, keys, mouse, screenshots and checks.
# Source this file after setting $out (a folder) and $size (size of the screen, such as 1280x720). When the
# script exits, the session and the screens that it opened are ended.
for tool in Xvfb xdotool import sqlite3; do
  command -v "$tool" >/dev/null || { echo "${0##*/}: $tool is missing; run scripts/setup.sh tools slow" >&2; exit 1; }
done
mkdir -p "$out"
width=${size%x*} height=${size#*x}
export OMP_WAIT_POLICY=passive
screens=()
session=
leave() { for p in $session "${screens[@]}"; do kill "$p" 2>/dev/null || true; done; }
trap leave EXIT

screen_of() {  # screen_of FILE SIZE: opens a virtual screen; FILE gets its number, $screen its process id
  : >"$1"
  Xvfb -displayfd 3 -noreset -screen 0 "${2}x24" 3>"$1" >/dev/null 2>&1 &
  screen=$!
  screens+=("$screen")
  until [ -s "$1" ]; do sleep 0.1; done
}

alive() { kill -0 "$session" 2>/dev/null; }
key() { for k in "$@"; do xdotool key "$k"; sleep 0.08; done; }
# pixel X Y: prints the colour of the screen at X Y: red, green and blue from 0 to 255.
pixel() { import -window root -crop "1x1+$1+$2" -depth 8 rgb:- | od -An -v -tu1 | xargs; }
shoot() { import -window root "$out/$1.png"; }
click() { xdotool mousemove "$1" "$2"; sleep 0.06; xdotool click 1; sleep 0.1; }
# The button to go on is 2.7 lines above the lower edge of the screen; a line is 2.96 % of the height.
button_y=$((height - height * 80 / 1000))
click_on() { click $((width / 2)) "$button_y"; }

bake_dam() {  # bake_dam FILE: bakes one second of the dam with pictures, unless FILE exists
  [ -f "$1" ] || "$study" bake data/scenes/single_dam.toml --method HiRes --n-star 512 --frames 60 --pictures 640x360 --out "$1"
}

failed=0
expect() {  # expect WHAT WANTED GOT: prints whether GOT equals WANTED; sets failed=1 if not
  if [ "$3" = "$2" ]; then printf 'ok      %s: %s\n' "$1" "$3"; else
    printf 'FAILED  %s: %s instead of %s\n' "$1" "$3" "$2"
    failed=1
  fi
}
