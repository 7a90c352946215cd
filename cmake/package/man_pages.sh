#!/usr/bin/env bash
# Makes a manual page for each program and each of its commands, from their --help.
# usage: man_pages.sh PROGRAMS_FOLDER MAN_FOLDER
set -euo pipefail
programs=$1 out=$2
here=$(dirname "$0")
mkdir -p "$out"

page() {  # page SEE PROGRAM [COMMAND]: writes the page, which refers to the page SEE
  local see=$1 program=$2 name text
  shift
  name=$(IFS=-; echo "$*")
  text=$("$programs/$program" "${@:2}" --help)
  awk -v name="$*" -v version="$version" -v date="$date" -v see="$see" -f "$here/man_page.awk" <<<"$text" |
    gzip -9n >"$out/$name.1.gz"
}

for program in vip-study vip-stats vip-bench vip-view; do
  said=$("$programs/$program" --version)
  version=$(sed -n '1s/.* //p' <<<"$said")
  date=$(sed -n 's/^built \([0-9-]*\).*/\1/p' <<<"$said")
  commands=$("$programs/$program" --help | awk '/^Subcommands:/ { listed = 1; next } listed && /^  [a-z]/ { print $1 }')
  page "${commands:+$program-}${commands%%$'\n'*}" "$program"
  for command in $commands; do page "$program" "$program" "$command"; done
done
