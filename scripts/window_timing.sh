#!/usr/bin/env bash
# Plays trials of ten seconds at the participant's window on a virtual screen, against the real clock. The
# timing certificate that is printed must agree with the records of the frames, and must mark trials that were
# disturbed by load or a frozen process. A trial whose window is minimised must be cut and shown again.
# usage: scripts/window_timing.sh [FOLDER]    default: out/window_timing
# Takes vip-study from $VIP_STUDY and set-minimised from $VIP_SET_MINIMISED, else both from build/dev.
# Whether undisturbed trials pass depends on the machine, and is printed but not checked.
set -euo pipefail
cd "$(dirname "$0")/.."
out=${1:-out/window_timing}
study=${VIP_STUDY:-build/dev/bin/vip-study}
set_minimised=${VIP_SET_MINIMISED:-build/dev/bin/set-minimised}
size=${VIP_SCREEN:-640x360}
. scripts/window_lib.sh
rm -f "$out"/*.{db*,log,events,frames}
bake_dam "$out/dam.bake"
screen_of "$out/screen" "$size"
DISPLAY=:$(cat "$out/screen")
export DISPLAY

name=
ask() { sqlite3 -cmd '.timeout 2000' "$out/$name.db" "$1"; }
write_pilot() {  # write_pilot MEANS SDS: writes the pilot with these settings only, of ten seconds each
  sed -e "s/^mean_fps = .*/mean_fps = [$1]/; s/^sd_fps = .*/sd_fps = [$2]/" protocols/ptpe_pilot.toml >"$out/$name.toml"
}
begin() {  # begin [COMMAND ...]: starts a simulated person's session at a real window, by COMMAND
  "$@" "$study" run "$out/$name.toml" --db "$out/$name.db" --participant P01 --observer random --display window \
    --stimulus "$out/dam.bake" --seed 5 --events >"$out/$name.events" 2>"$out/$name.log" &
  session=$!
}
end() {
  local status=0
  wait "$session" || status=$?
  session=
  [ $status -eq 0 ] || { cat "$out/$name.log" >&2; echo "window_timing: vip-study ended with $status" >&2; exit 1; }
  sed -n '/^Timing certificate/,$p' "$out/$name.events" >"$out/$name.certificate"
  sed "s/^/        /" "$out/$name.certificate"
}
under_way() {  # waits until ten frames of the trial are stored; frames are stored every half second
  until [ "$(ask "select count(*) > 9 from frame join presentation using (presentation_id) where state = 'running'" 2>/dev/null)" = 1 ]; do
    alive || { echo "window_timing: the session ended before a trial; see $out/$name.log" >&2; exit 1; }
    sleep 0.05
  done
}

# Computes mean, standard deviation, number of late frames and worst lateness of each setting, from the
# records of the frames alone. Each setting is shown once.
recomputed() {
  ask "select c.mean_fps, c.sd_fps, p.end_ns, p.start_ns + f.scheduled_ns + f.submitted_ns, f.submitted_ns
    from frame f join presentation p using (presentation_id) join cell c on c.cell = p.cell where p.state = 'played'
    order by c.cell, f.frame_index" | awk -F '|' '
    function close_interval(until) { n++; rate = 1e9 / (until - onset); time += 1 / rate; sum += rate; squares += rate * rate }
    function tell() {
      close_interval(end)
      printf "%g %g %.3f %.3f %d %.3f\n", mean, sd, n / time, sqrt(squares / n - (sum / n) ^ 2), late, worst / 1e6
      n = time = sum = squares = late = worst = 0
    }
    { if (NR > 1 && ($1 != mean || $2 != sd)) tell(); else if (NR > 1) close_interval($4)
      mean = $1; sd = $2; end = $3; onset = $4; late += $5 > 500000; if ($5 > worst) worst = $5 }
    END { tell() }'
}
# Prints the rows of recomputed() with the numbers that the certificate gives.
printed() { awk '$3 == 1 && NF >= 13 { print $1, $2, $4, $6, $8, $9 }' "$out/$name.certificate"; }
differences() {  # prints the rows that differ by more than one in the last printed digit
  paste -d ' ' "$out/$name.frames" <(printed) | awk 'NF != 12 { print; next }
    { for (i = 1; i <= 6; i++) { d = $i - $(i + 6); if (d > 0.0015 || d < -0.0015) { print; next } } }'
}
check_certificate() {  # check_certificate SETTINGS: compares it with the database; SETTINGS: number of rows
  recomputed >"$out/$name.frames"
  expect "$name: settings in the certificate" "$1" "$(printed | wc -l)"
  expect "$name: rows that differ from the frames' records" "" "$(differences)"
  expect "$name: frames marked late, and late ones" "$(ask "select sum(submitted_ns > 500000) from frame")" "$(ask "select sum(late) from frame")"
  expect "$name: showings without a verdict" 0 "$(ask "select count(*) from presentation where state = 'played' and verdict is null")"
  expect "$name: rows marked for what did not pass" "$(ask "select count(*) from presentation where verdict <> 'pass'")" \
    "$(grep -cE '(DEGRADED|[0-9] +[A-D] +FAIL)$' "$out/$name.certificate" || true)"
}

name=quiet
write_pilot "20, 50" "0, 5"
begin
end
check_certificate 4
echo "        display: $(ask "select display from session")"
echo "        scheduling: $(ask "select detail from event where kind = 'scheduling'")"

# Load: twice as many busy loops as cores, which have a higher priority than the session (nice -n 5).
name=load
write_pilot 50 "0, 5"
loops=()
for ((i = 0; i < 2 * $(nproc); ++i)); do
  (while :; do :; done) &
  loops+=("$!")
done
trap 'kill "${loops[@]}" 2>/dev/null || true; leave' EXIT
begin nice -n 5
end
kill "${loops[@]}"
wait "${loops[@]}" 2>/dev/null || true
check_certificate 2
expect "load: some setting does not pass" 1 "$(ask "select count(*) > 0 from presentation where verdict <> 'pass'")"

# The process is stopped for 300 ms. Six frames of 50 ms are due in this time; the first of them is shown late
# by the rest of the 300 ms.
name=frozen
write_pilot 20 0
begin
under_way
kill -STOP "$session"
sleep 0.3
kill -CONT "$session"
end
check_certificate 1
expect "frozen: at least five frames are late" 1 "$(ask "select late_frames >= 5 from presentation")"
expect "frozen: the worst by 250 ms or more" 1 "$(ask "select worst_late_ms >= 250 from presentation")"
expect "frozen: the longest interval shows it" 1 "$(ask "select longest_ms >= 290 from presentation")"
expect "frozen: the verdict" fail "$(ask "select verdict from presentation")"

# A minimised window shows nothing: the trial is cut at once, and it is shown again after the window is
# restored.
name=minimised
write_pilot 20 0
begin
under_way
"$set_minimised" vip-study yes
sleep 2
expect "minimised: cut at once" interrupted "$(ask "select state from presentation")"
expect "minimised: nothing is shown meanwhile" 1 "$(ask "select count(*) from presentation")"
"$set_minimised" vip-study no
end
expect "minimised: shown again" "interrupted played" "$(ask "select group_concat(state, ' ') from (select state from presentation order by attempt)")"
expect "minimised: why" 1 "$(ask "select count(*) from note where words like '%window was minimised'")"
expect "minimised: answers" 2 "$(ask "select count(*) from response")"
expect "minimised: session" done "$(ask "select state from session")"
exit $failed
