#!/usr/bin/env bash
# clang-tidy with the checks of .clang-tidy on the C++ that changed since BASE, committed or not; what it finds is an error.
# usage: scripts/tidy.sh [BASE]           default: $VIP_TIDY_BASE, or where this branch left origin/main
#        scripts/tidy.sh --files FILE...  these sources
# A header is looked at through a source that includes it. Without --files no more than $VIP_TIDY_MOST sources (default: 16) are
# looked at, which takes up to two minutes on two cores; the rest is named.
set -euo pipefail
cd "$(dirname "$0")/.."
changed() {  # changed [BASE]: C++ files that differ from there
  local base=${1:-${VIP_TIDY_BASE:-}}
  [ -n "$base" ] || base=$(git merge-base HEAD origin/main 2>/dev/null || git merge-base HEAD main 2>/dev/null || true)
  git rev-parse --verify -q "$base^{commit}" >/dev/null || { echo "tidy: no earlier commit is known here" >&2; return; }
  { git diff --name-only --diff-filter=d "$base"; git ls-files -o --exclude-standard; } | grep -E '\.[ch]pp$' | sort -u || true
}
source_of() {  # source_of FILE: itself, or for a header a source that reads it
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
# Without precompiled headers, which clang cannot read from g++, and each source by itself.
cmake --preset dev -B build/tidy -DVIP_PRECOMPILE=OFF -DVIP_UNITY=OFF -DVIP_CUDA=OFF >/dev/null
# A build makes this file from the sources of the solver; here any text will do.
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
