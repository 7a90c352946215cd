#!/usr/bin/env bash
# Kills and full disks in every command that keeps data, and first starts beside each other; after each a check that nothing
# is lost, doubled, changed or refused. Builds what it needs and ends with counts; exit status 1 when anything was lost.
# Usage: scripts/kills.sh [KILLS [SEED]]      default 1000 kills; JOBS=n workers side by side, default one for each processor
set -euo pipefail
cd "$(dirname "$0")/.."
kills=${1:-1000} seed=${2:-1} jobs=${JOBS:-$(nproc)}
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
exit $failed
