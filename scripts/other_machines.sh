#!/usr/bin/env bash
# Runs the CPU tests as another machine would: compiled with other flags, and with other numbers of threads.
# Prints a table last.
# usage: scripts/other_machines.sh [--only "VARIANT ..."] [--target PROGRAM] [FILTER]
#   VARIANT  native (-march=native), o1 (-O1), threads-1, threads-3, threads-many (twice the cores); default: all
#   PROGRAM  test program to build and run, such as sim_test; default: all tests that need neither GPU nor minutes
#   FILTER   regular expression of test names; default: every one
# The native and o1 variants are built in build/native and build/o1. The variants with other numbers of
# threads use build/dev, which is built only if it does not exist. Logs go to out/other_machines.
set -uo pipefail
cd "$(dirname "$0")/.." || exit 2
variants="native o1 threads-1 threads-3 threads-many" target=all
while [ $# -gt 0 ]; do
  case $1 in
    --only) variants=$2; shift 2 ;;
    --target) target=$2; shift 2 ;;
    *) break ;;
  esac
done
filter=${1:-.}
out=out/other_machines
mkdir -p "$out"
table=$out/table.txt
printf '%-14s %8s %8s %8s\n' variant tests failed seconds >"$table"
failed=0

build() {  # build FOLDER FLAGS: builds the dev preset with these flags in place of its -O2
  cmake --preset dev -B "build/$1" -DVIP_CUDA=OFF -DCMAKE_CXX_FLAGS_RELWITHDEBINFO="$2 -DNDEBUG" >"$out/$1.build.log" 2>&1 &&
    cmake --build "build/$1" --target "$target" >>"$out/$1.build.log" 2>&1 && return
  tail -n 15 "$out/$1.build.log" >&2
  return 1
}

select_tests() {  # select_tests PROGRAM: prints the tests that match FILTER, except of suites *Gpu and *Slow, for --gtest_filter
  "$1" --gtest_list_tests | awk '/^[^ ]/ { suite = $1; next } { print suite $1 }' | grep -E -- "$filter" |
    grep -vE '^[^.]*(Gpu|Slow)\.' | paste -sd:
}

try() {  # try VARIANT FOLDER THREADS: runs the tests; THREADS empty: one thread for each core
  local log=$out/$1.log start=$SECONDS tests bad
  (
    [ -z "$3" ] || export OMP_NUM_THREADS=$3
    if [ "$target" = all ]; then
      ctest --test-dir "build/$2" -LE 'gpu|slow' -R "$filter" --no-tests=error --output-on-failure
    else
      "build/$2/tests/$target" --gtest_filter="$(select_tests "build/$2/tests/$target")"
    fi
  ) >"$log" 2>&1 || { failed=1; grep -E '^\[  FAILED  \]|\(Failed\)' "$log" | sort -u >&2; }
  tests=$(sed -nE 's/^.* tests failed out of ([0-9]+)$/\1/p; s/^\[=+\] ([0-9]+) tests? .* ran.*/\1/p' "$log" | tail -n 1)
  bad=$(sed -nE 's/^.*, ([0-9]+) tests failed out of .*/\1/p; s/^ *([0-9]+) FAILED TESTS?$/\1/p' "$log" | tail -n 1)
  printf '%-14s %8s %8s %8s\n' "$1" "${tests:-none}" "${bad:-0}" $((SECONDS - start)) >>"$table"
}

for variant in $variants; do
  case $variant in
    native) build native "-O2 -march=native" && try native native "" ;;
    o1) build o1 -O1 && try o1 o1 "" ;;
    threads-1 | threads-3 | threads-many)
      [ -d build/dev ] || build dev -O2
      n=${variant#threads-}
      [ "$n" != many ] || n=$((2 * $(nproc)))
      try "$variant" dev "$n" ;;
    *) echo "other_machines: no variant '$variant'" >&2; exit 2 ;;
  esac || { failed=1; printf '%-14s %8s\n' "$variant" "no build" >>"$table"; }
done
cat "$table"
exit $failed
