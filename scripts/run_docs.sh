#!/usr/bin/env bash
# Runs every command line that a page quotes in its "sh" blocks, unchanged, in a fresh copy of the project. A
# page fails if a command ends with an error or does not write an output file that it names, if the page names
# a test or a script that does not exist, or if a row of the table below matches none of its commands. The
# table lists the commands that cannot run unchanged, and why. The row of a skipped command names the test
# that runs the command instead; that test must exist.
# usage: scripts/run_docs.sh [PAGE ...]      default: every page; copies, logs and durations go to out/docs
# Takes the programs from $VIP_BUILD (default: build/dev). Only README.md builds its own programs.
# VIP_DOCS_QUICK=1 skips the commands that the table calls slow.
set -euo pipefail
cd "$(dirname "$0")/.."
root=$PWD
build=$(realpath "${VIP_BUILD:-build/dev}")
out=$(realpath -m "${VIP_DOCS_OUT:-out/docs}")
export VIP_STATE_DIR=$out/state  # keeps the pages' exports out of the user's own register of exports
[ $# -gt 0 ] || set -- README.md docs/*.md

# Columns: PAGE | BEGINNING OF THE COMMAND | HOW IT RUNS | WHY | TEST
# HOW IT RUNS is one of: "person" (keys on a virtual screen answer the pages of the command), a sed script
# that changes the command, "skip", or "slow" (the command is skipped only in a quick run).
table="
README.md|./scripts/test.sh|skip|it is what runs this|.ci/run
README.md|vip-study run protocols/ptpe_pilot.toml|person||
docs/methods.md|vip-view --headless data/scenes/boat.toml|s/frames 61 --every 60/frames 3 --every 2/; s/800x600/160x120/|it takes minutes on two cores|
docs/methods.md|vip-view --headless data/scenes/crates.toml|s/frames 81 --every 80/frames 3 --every 2/; s/800x600/160x120/|it takes minutes on two cores|
docs/methods.md|vip-view --headless data/scenes/hot_jet.toml|s/4k/64/|it takes minutes on two cores|
docs/methods.md|vip-view --headless data/scenes/pool_light.toml|s/2k/64/; s/151/3/; s/150/2/; s/800x600/160x120/|it takes minutes on two cores|
docs/methods.md|vip-bench table1|s/32k/64/|a GPU works on it for minutes|
docs/results.md|snakemake -s scripts/sweep.smk --cores 2|s/--quick/--quick --n-star 64 --seconds 0.1 --seeds 1/|it takes more than a minute on two cores|
docs/results.md|vip-bench table1 --scene all --n-star 32k --repeats 5 --cumul-frames 0|s/all/Faucet/; s/32k/64/; s/repeats 5/repeats 1 --size 160x90/; s/cuda/cpu/|a GPU works on it for minutes|
docs/results.md|vip-bench table1|s/all/Faucet/; s/32k/64/; s/repeats 5/repeats 1 --cumul-frames 0/; s/cuda/cpu/|a GPU works on it for minutes|
docs/results.md|vip-bench effects data/scenes/splash.toml --levels|s/512/64 --frames 2/; s/480x360/120x90/|it takes minutes on two cores|
docs/results.md|vip-bench effects|s/4k/64/; s/cuda/cpu/; s/frames [0-9]*/frames 2/|it needs a GPU|
docs/results.md|vip-bench growth|s/4k,16k,32k,128k/64,128,256/; s/cuda/cpu/; s/frames [0-9]*/frames 2/|it needs a GPU|
docs/results.md|vip-bench frame data/scenes/pool_light.toml|s/2k/64/; s/frames [0-9]*/frames 2/; s/960x540/160x90/|it takes a minute on two cores|
docs/results.md|vip-bench frame data/scenes/single_dam.toml --n-star 32k|s/32k/64/; s/cuda/cpu/; s/frames [0-9]*/frames 2/; s/2064x2208/64x64/|it needs a GPU|
docs/results.md|vip-bench frame data/scenes/peers_dam.toml --n-star 32k|s/32k/64/; s/cuda/cpu/|it needs a GPU|
docs/results.md|vip-bench frame data/scenes/peers_dam.toml --n-star 128k|s/128k/64/; s/cuda/cpu/; s/frames [0-9]*/frames 2/|it needs a GPU|
docs/results.md|vip-bench frame --peers --backend cuda|s/cuda/cpu --frames 2/|it needs a GPU|
docs/results.md|vip-bench surface|s/surface/surface --n-star 64 --warm-up 4 --frames 8 --timed-frames 1 --size 96x64/|it takes minutes on two cores|
docs/results.md|vip-bench stability --case S9,S11,S12|s/S9,S11,S12/S9 --method HiRes --quick/|it takes minutes on two cores|
docs/results.md|vip-bench stability|s/--csv/--case S9 --method HiRes --quick --csv/|every core works on it for minutes|
docs/results.md|vip-bench frame out/dam_foam.toml|s/32k/64/; s/cuda/cpu/; s/frames 240/frames 2/|it needs a GPU|
docs/session.md|vip-study check|slow|it draws a picture of each cell|DocsSlow.docs/session.md
docs/session.md|vip-study run protocols/task1.toml --db lab1.db|s/--console/--observer random --clock virtual --display none/|half an hour of a person before a fast computer|scripts/window_protocols.sh
docs/session.md|vip-study bake --protocol|skip|hours on two cores|BakeProtocolE2e.ARerunKeepsWhatIsGoodAndMakesTheRestAgain
"
outputs='--(out|into|db|html|json|svg|csv|png|bids|psych-ds|preview|cells|checkpoints-to)'

# Prints the command lines of a page's sh blocks, with continuation lines joined and comments removed.
commands_of() {
  awk '/^```/ { shell = !inside && $0 == "```sh"; inside = !inside; next }
       shell { line = line $0; if (sub(/\\$/, "", line)) next; print line; line = "" }' "$1" |
    sed 's/  *#.*//; s/   */ /g; /^$/d'
}

failed=0
fail() { printf 'FAILED  %s: %s\n' "$page" "$1" >&2; failed=1; }

# Prints an error for each block that names no known language and for each indented command: neither would be
# run.
check_blocks() {
  awk '/^```/ { if (!inside && $0 !~ /^```(sh|text|cpp|json|toml|python|mermaid)$/) print NR; inside = !inside; next }
       !inside && /^    (\.\/)?(vip-|scripts|ctest|cmake|build)/ { print NR }' "$1" |
    while read -r line; do echo "line $line: a block of commands begins with \`\`\`sh, others with text, cpp, json, toml, python or mermaid"; done
}

# Checks that the tests and scripts that the page names in its text exist. If some test programs are not
# built, a test that is not found is no error.
check_names() {
  local spans name
  spans=$(sed '/^```/,/^```/d' "$1" | tr '\n' ' ' | grep -oE '`[^`]+`' || true)
  for name in $(sed -nE "s/.*ctest .*-R +'?([^'\` ]+).*/\1/p; s/.*--gtest_filter='?([A-Za-z0-9_]+).*/\1/p" <<<"$spans" | sort -u); do
    [ "$(count_tests "$name")" != 0 ] || [ "$(count_tests _NOT_BUILT)" != 0 ] || fail "names a test that does not exist: $name"
  done
  for name in $(grep -oE 'scripts/[a-z_]+\.sh' <<<"$spans" | sort -u); do
    [ -x "$root/$name" ] || fail "names a script that does not exist: $name"
  done
}
tests=$(ctest --test-dir "$build" -N | sed -n 's/^ *Test *#[0-9]*: //p')
count_tests() { grep -cE -- "$1" <<<"$tests" || true; }

check_test() {  # check_test NAME: NAME must be a file of the project or a test of the build
  [ -e "$root/$1" ] || [ "$(count_tests "^${1//./\\.}\$")" = 1 ] || [ "$(count_tests _NOT_BUILT)" != 0 ] ||
    fail "the table names a test that does not exist: $1"
}

row_for() {  # row_for COMMAND: prints the row of the table that applies to the command
  local of begins how why test
  while IFS='|' read -r of begins how why test; do
    if [ "$of" = "$page" ] && [[ $1 == "$begins"* ]]; then printf '%s|%s|%s|%s\n' "$begins" "$how" "$why" "$test"; fi
  done <<<"$table"
}

# Presses a digit and Return about once a second, whatever page is shown. On a consent page 1 means yes; on
# other pages each digit is a rating.
press_keys() {
  local n=0
  while true; do
    key $((n++ % 7 + 1)) || true
    sleep 0.4
    key Return || true
    sleep 0.5
  done
}
answer_by_keys() {  # answer_by_keys COMMAND: runs it on a virtual screen, with press_keys()
  size=1280x720
  (
    out=$folder/screen
    . "$root/scripts/window_lib.sh"
    screen_of "$out/number" "$size"
    DISPLAY=:$(cat "$out/number")
    export DISPLAY
    press_keys &
    screens+=($!)
    eval "$1" </dev/null
  )
}

run_command() {  # run_command COMMAND: runs it in the page's folder, as the table says
  local command=$1 row begins how='' why='' test='' status=0 start=$SECONDS
  row=$(row_for "$command")
  if [ -n "$row" ]; then
    IFS='|' read -r begins how why test <<<"$row"
    used+="$begins"$'\n'
    [ -z "$test" ] || check_test "$test"
  fi
  case $how in
    slow) [ -n "${VIP_DOCS_QUICK:-}" ] && how=skip || how='' ;;
  esac
  case $how in
    skip) printf '%6s  %s\n        (%s; %s)\n' - "$command" "$why" "$test"; return ;;
    person) answer_by_keys "$command" >>"$log" 2>&1 || status=$? ;;
    *)
      [ -z "$how" ] || command=$(sed "$how" <<<"$command")
      eval "$command" </dev/null >>"$log" 2>&1 || status=$? ;;
  esac
  printf '%4d s  %s\n' $((SECONDS - start)) "$command"
  if [ $status -ne 0 ]; then fail "exit status $status: $command"; tail -n 15 "$log" >&2; return; fi
  for made in $(grep -oE -- "$outputs [^ ]+" <<<"$command" | cut -d ' ' -f 2); do
    [ -e "$made" ] || fail "$made is not there after: $command"
  done
}

run_page() {  # run_page PAGE: call it in a subshell, so that the page's exports do not reach other pages
  page=$1 folder=$out/${1//\//_} used=''
  log=$folder.log
  rm -rf "$folder"
  mkdir -p "$folder"
  : >"$log"
  [ -z "$(commands_of "$root/$page")" ] || tar -C "$root" --exclude=./build --exclude=./out --exclude=./.git -c . | tar -C "$folder" -x
  cd "$folder"
  local wrong command begins of rest
  wrong=$(check_blocks "$root/$page")
  [ -z "$wrong" ] || fail "$wrong"
  check_names "$root/$page"
  if [ "$page" != README.md ]; then
    mkdir build
    ln -s "$build" build/dev
    ln -s "$build" build/release
    PATH=$folder/build/release/bin:$PATH
  fi
  while IFS= read -r command; do run_command "$command"; done < <(commands_of "$root/$page")
  while IFS='|' read -r of begins rest; do
    if [ "$of" = "$page" ] && ! grep -qxF -- "$begins" <<<"$used"; then fail "the table's row matches no command: $begins"; fi
  done <<<"$table"
  cd "$root"
  [ $failed -ne 0 ] || rm -rf "$folder"
  return $failed
}

status=0
for each; do
  echo "== $each"
  (run_page "$each") || status=1
done
exit $status
