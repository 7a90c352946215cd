#!/usr/bin/env bash
# Runs clang-tidy with the checks of .clang-tidy on the C++ sources that changed since BASE, committed or not.
# Every finding is an error.
# usage: scripts/tidy.sh [BASE]           default: $VIP_TIDY_BASE, else the merge base with origin/main or
# main
#        scripts/tidy.sh --files FILE...  checks these sources
# A header is checked through a source that includes it. Without --files at most $VIP_TIDY_MOST sources
# (default: 16) are checked, which takes up to two minutes on two cores; the names of the other sources are
# printed.
set -euo pipefail
cd "$(dirname "$0")/.."
changed() {  # changed [BASE]: prints the C++ files that differ from BASE
  local base=${1:-${VIP_TIDY_BASE:-}}
  [ -n "$base" ] || base=$(git merge-base HEAD origin/main 2>/dev/null || git merge-base HEAD main 2>/dev/null || true)
  git rev-parse --verify -q "$base^{commit}" >/dev/null || { echo "tidy: no earlier commit is known here; name one: scripts/tidy.sh BASE" >&2; return; }
  { git diff --name-only --diff-filter=d "$base"; git ls-files -o --exclude-standard; } | grep -E '\.[ch]pp$' | sort -u || true
}
source_of() {  # source_of FILE: prints FILE, or for a header a source that includes it
  case $1 in
    *.cpp) echo "$1" ;;
    *) if [ -f "${1%.hpp}.cpp" ]; then echo "${1%.hpp}.cpp"; else git grep -lF "\"$1\"" -- '*.cpp' | sed -n 1p || true; fi ;;
  esac
}

if [ "${1:-}" = --files ]; then
  shift
  sources=("$@")
else
  mapfile -t sources < <(changed "$@" | while read -r file; do source_of "$file"; done | sort -u)
  most=${VIP_TIDY_MOST:-16}
  if [ ${#sources[@]} -gt "$most" ]; then
    echo "tidy: ${#sources[@]} sources changed; not looked at: ${sources[*]:most}"
    sources=("${sources[@]:0:most}")
  fi
fi
[ ${#sources[@]} -gt 0 ] || { echo "tidy: nothing changed"; exit 0; }

./scripts/setup.sh lint
# Configures without precompiled headers, because clang cannot read those of g++, and without units of several
# sources.
cmake --preset dev -B build/tidy -DVIP_PRECOMPILE=OFF -DVIP_UNITY=OFF -DVIP_CUDA=OFF >/dev/null
# The build generates this file from the solver's libraries. For clang-tidy any string literal will do.
[ -f build/tidy/libsim/solver_digest.inc ] || echo '""' >build/tidy/libsim/solver_digest.inc
known=()
for source in "${sources[@]}"; do
  if grep -qF "\"$PWD/$source\"" build/tidy/compile_commands.json; then known+=("$source"); fi
done
[ ${#known[@]} -gt 0 ] || { echo "tidy: nothing that changed is compiled"; exit 0; }
printf '%s\0' "${known[@]}" | xargs -0 -P "$(nproc)" -n 1 clang-tidy -p build/tidy --quiet \
  --extra-arg=-Wno-unknown-warning-option --extra-arg=-Wno-ignored-optimization-argument \
  --extra-arg=-Wno-unused-command-line-argument 2> >(grep -v 'warnings\? generated\|^Suppressed\|^Use -' >&2)
echo "tidy: ${#known[@]} sources are clean"
