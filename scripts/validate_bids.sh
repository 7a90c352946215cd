#!/usr/bin/env bash
# Checks BIDS exports with the standard's validator, which npm installs once into build/tools.
# usage: scripts/validate_bids.sh [FOLDER...]   without a folder it only installs
# Exit status: 0 no folder has an error, 1 a folder has an error (printed on stdout), 77 the validator cannot
# be installed (no npm, or no package registry).
set -euo pipefail
version=1.15.0
tools=$(cd "$(dirname "$0")/.." && pwd)/build/tools
installed=$tools/bids-validator-$version
skip() { echo "validate_bids: $1; skipped" >&2; exit 77; }

install() {
  command -v npm >/dev/null || skip "npm is missing (Debian: nodejs npm)"
  echo "validate_bids: installs bids-validator $version into build/tools, some 3 minutes" >&2
  npm install --prefix "$tools" --ignore-scripts --no-audit --no-fund --fetch-retries 1 "bids-validator@$version" \
    >"$tools/npm.log" 2>&1 || skip "bids-validator $version cannot be installed (build/tools/npm.log)"
  touch "$installed"
}

mkdir -p "$tools"
exec 9>"$tools/lock"
flock 9
[ -e "$installed" ] || install
flock -u 9
failed=0
for folder in "$@"; do
  node --no-warnings "$tools/node_modules/bids-validator/bin/bids-validator" --ignoreWarnings --no-color "$folder" || failed=1
done
exit $failed
