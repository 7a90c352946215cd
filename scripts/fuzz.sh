#!/usr/bin/env bash
# Fuzzes the reader of every file format (tests/fuzz) with clang's libFuzzer under the address and
# undefined-behaviour sanitizers, and prints a table. Inputs that fail are kept in
# build/fuzz/findings/<format>/found.
# Exit status: 0 no finding, 1 findings, 77 clang is missing.
# Usage: scripts/fuzz.sh [--binaries DIR] [SECONDS [JOBS [FORMAT ...]]]
#   SECONDS          duration for each format (default: 60)
#   JOBS             parallel jobs (default: one for each processor); if there are at least two jobs for each
#                    format, the jobs of a format share their inputs
#   FORMAT           formats to fuzz (default: all)
#   --binaries DIR   runs the programs in DIR, built elsewhere (build/fuzz/tests/fuzz), instead of building them
set -euo pipefail
cd "$(dirname "$0")/.."
binaries=
if [ "${1:-}" = --binaries ]; then binaries=$2; shift 2; fi
seconds=${1:-60} jobs=${2:-$(nproc)}
shift $(($# < 2 ? $# : 2))
if [ -z "$binaries" ]; then
  command -v clang++ >/dev/null || { echo "fuzz.sh: clang++ is missing (Debian: clang libclang-rt-14-dev libomp-dev); skipped" >&2; exit 77; }
  cmake --preset fuzz >/dev/null
  cmake --build build/fuzz --target fuzz_all >&2
  binaries=build/fuzz/tests/fuzz
fi
out=build/fuzz/findings
mkdir -p "$out"
formats=("$@")
[ ${#formats[@]} -gt 0 ] || for program in "$binaries"/fuzz_*; do
  [ -f "$program" ] && [ -x "$program" ] && formats+=("${program##*/fuzz_}")
done

fuzz() {  # fuzz FORMAT/JOB: keeps new inputs in corpus/ for the next run, and inputs that fail in found/
  local format=${1%/*} here=$out/${1%/*}
  mkdir -p "$here/corpus" "$here/found"
  "$binaries/fuzz_$format" -max_total_time="$seconds" -timeout=25 -rss_limit_mb=4096 -print_final_stats=1 \
    -artifact_prefix="$here/found/" "$here/corpus" "tests/fuzz/corpus/$format" >"$here/log.${1#*/}" 2>&1 || true
}
export -f fuzz
export out binaries seconds UBSAN_OPTIONS=print_stacktrace=1 OMP_NUM_THREADS=1
# The programs read the project's files from here, even if they were built in another folder.
export VIP_SHARE_DIR=$PWD
each=$((jobs > ${#formats[@]} ? jobs / ${#formats[@]} : 1))
for format in "${formats[@]}"; do
  rm -f "$out/$format"/log*
  for ((job = 1; job <= each; ++job)); do echo "$format/$job"; done
done | xargs -P "$jobs" -I{} bash -c 'fuzz {}'

failed=0
printf '%-12s %12s %8s %10s %9s\n' format executions seconds coverage findings
for format in "${formats[@]}"; do
  logs=("$out/$format"/log.*)
  read -r ended runs took <<<"$(grep -ha '^Done [0-9]* runs' "${logs[@]}" | awk '{ n += $2; s += $5 } END { print NR, n + 0, s + 0 }')"
  cover=$({ grep -hoa ' cov: [0-9]*' "${logs[@]}" || true; } | awk '$2 > most { most = $2 } END { print most }')
  found=$(find "$out/$format/found" -type f | wc -l)
  # A job that did not end by itself has failed, even if it left no input.
  [ "$found" -eq 0 ] && [ "$ended" -eq "$each" ] || failed=1
  [ "$ended" -eq "$each" ] || took=cut
  printf '%-12s %12s %8s %10s %9s\n' "$format" "$runs" "$took" "${cover:-?}" "$found"
done
[ $failed -eq 0 ] || echo "findings and logs: $out"
exit $failed
