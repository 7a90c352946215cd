#!/usr/bin/env bash
# Demonstrates the main workflow on this machine: installs packages, builds, and runs every step from a scene
# to the file of the fitted model that the solver reads.
# usage: scripts/demo.sh        results go to out/demo/; a further run replaces them
set -euo pipefail
cd "$(dirname "$0")/.."
out=out/demo
bin=build/release/bin
observer=ptpe:a=24,b=0.02
# Makes waiting OpenMP threads sleep instead of spin. The programs would set this themselves and restart.
export OMP_WAIT_POLICY=passive

phases=()
phase() {  # phase TEXT: ends the last phase and starts the next
  local now=$SECONDS
  [ ${#phases[@]} -eq 0 ] || phases[-1]+=$'\t'$((now - phase_start))
  phase_start=$now
  [ -z "${1:-}" ] && return
  phases+=("$1")
  printf '\n== %s\n' "$1"
}
run() {  # run COMMAND...: prints the command, then runs it
  printf '\n$ %s\n' "$*"
  "$@" </dev/null
}

phase "Set up"
run ./scripts/setup.sh build
phase "Build"
run cmake --preset release
# One job per processor: with ninja's additional job the same build took 5 % more processor time on two processors.
run cmake --build --preset release --parallel "$(nproc)" --target vip-study vip-stats vip-view
built=$SECONDS

mkdir -p "$out"
for made in dam.bake check.json pacing.db study.db short_pauses.toml csv fit.json fitted.toml heat.svg pictures; do
  [ ! -e "$out/$made" ] || echo "demo: replaces $out/$made"
  rm -rf "${out:?}/$made" "$out/$made"-{wal,shm,journal} "$out/$made.answers.jsonl"
done

phase "What a headset with 90 Hz makes of the 21 settings"
run $bin/vip-study check protocols/ptpe_pilot.toml --refresh 90 --json $out/check.json

phase "Bake SingleDam: particles and pictures"
run $bin/vip-study bake data/scenes/single_dam.toml --method HiRes --n-star 2k --frames 60 \
  --pictures 640x360 --out $out/dam.bake

phase "Play the 21 settings in real time, 1 s each, every frame rendered"
# This copy of the protocol shows black for 0.25 s before each trial, not 3 s, since a simulated observer
# needs no rest.
run sed -n 's/"black 3"\(.*]\).*/"black 0.25"\1/; w '$out/short_pauses.toml protocols/ptpe_pilot.toml
run $bin/vip-study run $out/short_pauses.toml --db $out/pacing.db --participants 1 --observer $observer \
  --clock real --display headless --stimulus $out/dam.bake --trial-seconds 1

phase "Run 16 simulated participants through the whole pilot on the virtual clock"
run $bin/vip-study run protocols/ptpe_pilot.toml --db $out/study.db --participants 16 --observer $observer \
  --clock virtual --display none --seed 7
run $bin/vip-study status --db $out/study.db
run $bin/vip-study export --db $out/study.db --csv $out/csv

phase "Fit mu = a exp(b delta)"
run $bin/vip-stats fit-ptpe $out/study.db --level 4 --truth $observer --out $out/fitted.toml \
  --json $out/fit.json --svg $out/heat.svg

phase "Hand the fit to the solver and render"
run $bin/vip-view --headless data/scenes/single_dam.toml --method HiRes --n-star 2k --frames 61 --every 60 \
  --size 640x360 --png $out/pictures --ptpe $out/fitted.toml

phase ""
printf '\n== Done: %d s, of which %d s after the build\n' $SECONDS $((SECONDS - built))
for line in "${phases[@]}"; do printf '%6d s  %s\n' "${line##*$'\t'}" "${line%$'\t'*}"; done
printf '\nfiles in %s:\n' $out
describe() { printf '  %-28s %s\n' "$1" "$2"; }
describe check.json "what 90 Hz makes of the protocol"
describe dam.bake "frames and pictures of SingleDam"
describe short_pauses.toml "the protocol of the real-time run"
describe pacing.db "the real-time run: every frame's times and every trial's verdict"
describe study.db "16 simulated participants"
describe csv/ "study.db as tables with a data dictionary"
describe fit.json "every number of the fit"
describe heat.svg "mean scores with the contours at 4 and 5"
describe fitted.toml "a and b for the solver"
describe pictures/frame_0060.png "SingleDam after 1 s"
cat <<END

Sixteen simulated people rated SingleDam at 21 settings of frame rate. The curve of acceptable rates was fitted to
their ratings, and the solver drew its last picture with that curve. Next you can:
  $bin/vip-view data/scenes/single_dam.toml --n-star 2k                  look at the fluid (needs a screen)
  $bin/vip-stats report $out/study.db --html $out/report.html   read these people's study as one page
  $bin/vip-study run protocols/ptpe_pilot.toml --db my.db --participant P01 \\
    --stimulus $out/dam.bake --trial-seconds 3                           take part yourself (needs a screen)
END
