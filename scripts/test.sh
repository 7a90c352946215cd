#!/usr/bin/env bash
# Sets up, builds with warnings as errors, looks at what changed with clang-tidy, and runs every test that needs no GPU.
set -euo pipefail
cd "$(dirname "$0")/.."
./scripts/setup.sh
cmake --preset dev
cmake --build --preset dev
./scripts/tidy.sh
./scripts/validate_bids.sh || [ $? -eq 77 ]  # its tests are skipped without it
ctest --preset dev
