#!/usr/bin/env bash
# Injects kills and full disks into every command that stores data, and starts sessions on new databases
# simultaneously. After each fault it checks that no data are lost, stored twice or changed, and that no
# command refuses to continue. Then it simulates power cuts in the commands that carry out people's decisions,
# under both models of a file system (tests/faults/crash_states.hpp), and runs random histories of three
# stations. It builds what it needs and prints counts. Exit status 1 if any check fails.
# Usage: scripts/kills.sh [KILLS [SEED [HISTORIES]]]      default 1000 kills, seed 1, 1000 histories
#        JOBS=n workers side by side, default one for each processor
set -euo pipefail
cd "$(dirname "$0")/.."
kills=${1:-1000} seed=${2:-1} histories=${3:-1000} jobs=${JOBS:-$(nproc)}
faults=build/dev/bin/vip-faults
if [ -z "${VIP_FAULTS:-}" ]; then
  [ -f build/dev/build.ninja ] || cmake --preset dev -DVIP_CUDA=OFF >/dev/null
  cmake --build --preset dev --target vip-faults vip-study
else
  faults=$VIP_FAULTS
fi
failed=0
"$faults" kills "$kills" --seed "$seed" --jobs "$jobs" || failed=1
"$faults" starts 300 --jobs "$jobs" || failed=1
cuts() { "$faults" crashes --kills "$1" --seed "$seed" --jobs "$jobs" "${@:2}" || failed=1; }
cuts 500 --command 'consent no' --command 'consent yes'
cuts 300 --command withdraw --command merge --command 'export --csv' --command 'export --bids' --command 'export --psych-ds'
"$faults" histories "$histories" --seed "$seed" --jobs "$jobs" || failed=1
exit $failed
