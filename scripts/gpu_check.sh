#!/usr/bin/env bash
# Builds on a CUDA machine, runs every GPU test and the benches in one go, and prints a short table last.
# usage: scripts/gpu_check.sh [FOLDER]     logs and figures go to FOLDER (default: out/gpu)
set -uo pipefail
cd "$(dirname "$0")/.."
out=${1:-out/gpu}
mkdir -p "$out"
table="$out/table.txt"
: >"$table"
failed=0

note() { printf '%-34s %s\n' "$1" "$2" | tee -a "$table"; }

step() {  # step NAME COMMAND...: runs the command, keeps its log, adds ok or FAILED to the table
  local name=$1 start=$SECONDS
  shift
  if "$@" >"$out/$name.log" 2>&1; then
    note "$name" "ok ($((SECONDS - start)) s)"
  else
    note "$name" "FAILED ($((SECONDS - start)) s), see $out/$name.log"
    tail -n 15 "$out/$name.log"
    failed=1
  fi
}

figure() {  # figure NAME JSON-FILE: prints the table's line of one bench
  [ -f "$2" ] || return 0
  python3 - "$1" "$2" <<'PY' | tee -a "$table"
import json, sys
name, path = sys.argv[1:]
r = json.load(open(path))
render = r.get("render_ms_median")
print(f"{name:34s} {r['particles']} particles on {r['backend']}: solve {r['solve_ms_median']:.3f} ms (p95 {r['solve_ms_p95']:.3f}), "
      + (f"render {render:.3f} ms, " if render is not None else "")
      + f"error {100 * r['density_error_mean']:.2f} %, h/d {r['h_over_d']:.1f}, neighbours {r['neighbours_mean']:.1f}")
PY
}

step configure cmake --preset release -DVIP_CUDA=ON -DVIP_WINDOW=OFF
step build cmake --build --preset release -j"$(nproc)"
[ "$failed" -eq 0 ] || exit 1
step gpu_tests ctest --test-dir build/release -L gpu --output-on-failure --no-tests=error
step gl_tests ctest --test-dir build/release -L gl --output-on-failure

bench=build/release/bin/vip-bench
for backend in cuda cpu; do
  for n_star in 4k 32k; do
    [ "$backend$n_star" = cpu32k ] && continue
    step "peers_dam_${backend}_$n_star" "$bench" frame data/scenes/peers_dam.toml --n-star "$n_star" --backend "$backend" \
      --frames 120 --json "$out/peers_dam_${backend}_$n_star.json"
    figure "peers dam, n_* $n_star" "$out/peers_dam_${backend}_$n_star.json"
  done
done
step single_dam_cuda_32k "$bench" frame data/scenes/single_dam.toml --n-star 32k --backend cuda --frames 120 \
  --json "$out/single_dam_cuda_32k.json"
figure "SingleDam, n_* 32k" "$out/single_dam_cuda_32k.json"
step peers "$bench" frame --peers --backend cuda --passes --json "$out/peers.json"
step growth "$bench" growth data/scenes/peers_dam.toml --n-star 16k,32k,128k,512k --backend cuda --frames 60 \
  --csv "$out/growth.csv" --svg "$out/growth.svg"
grep -h '^exponent' "$out/growth.log" | tee -a "$table"

echo
nvidia-smi --query-gpu=name,driver_version --format=csv,noheader 2>/dev/null
cat "$table"
exit "$failed"
