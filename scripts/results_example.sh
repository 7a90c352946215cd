#!/usr/bin/env bash
# Makes tests/apps/results_example.json: the results of a simulated pilot and of both lab tasks, as vip-stats
# report writes them.
# usage: scripts/results_example.sh [FILE]    Takes the programs from $VIP_BIN, else from build/dev/bin.
set -euo pipefail
cd "$(dirname "$0")/.."
file=${1:-tests/apps/results_example.json}
bin=$(realpath "${VIP_BIN:-build/dev/bin}")
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
simulate() {  # simulate PROTOCOL OBSERVER PARTICIPANTS: adds simulated sessions to the database
  "$bin/vip-study" run "protocols/$1.toml" --db "$folder/study.db" --observer "$2" --participants "$3" --seed 5 >/dev/null
}
simulate ptpe_pilot ptpe:a=31,b=0.035 8
simulate task1_lab frames 26
simulate task2_lab random 26
# The results contain the path of the database as given, so that the report is made in the folder of the
# database.
(cd "$folder" && "$bin/vip-stats" report study.db --json study.json >/dev/null)
sed 's/^ *//' "$folder/study.json" | tr -d '\n' >"$file"
