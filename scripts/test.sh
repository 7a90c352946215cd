#!/usr/bin/env bash
# Sets up, builds with warnings as errors, looks at what changed with clang-tidy, and runs every test that needs no GPU. Without a
# GPU the CUDA back end is not compiled: it takes minutes and none of its tests could run (scripts/gpu_check.sh).
set -euo pipefail
cd "$(dirname "$0")/.."
./scripts/setup.sh
cuda=OFF
nvidia-smi >/dev/null 2>&1 && cuda=AUTO
cmake --preset dev -DVIP_CUDA=$cuda
cmake --build --preset dev
./scripts/tidy.sh
./scripts/validate_bids.sh || [ $? -eq 77 ]  # its tests are skipped without it
ctest --preset dev
