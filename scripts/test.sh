#!/usr/bin/env bash
# Sets up, builds with warnings as errors, looks at what changed with clang-tidy, and runs every test
# that needs no GPU and is not labelled slow.
set -euo pipefail
cd "$(dirname "$0")/.."
./scripts/setup.sh build tests sweeps
cmake --preset dev
cmake --build --preset dev
./scripts/tidy.sh
ctest --preset dev
